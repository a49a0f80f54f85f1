"""Build of sher3_view for colcon; the root pyproject.toml installs every package with pip."""

from setuptools import find_packages, setup

NAME = "sher3_view"

setup(
    name=NAME,
    version="0.2.0",
    packages=find_packages(exclude=["test"]),
    package_data={"": ["py.typed", "static/*"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        (f"share/{NAME}/viewers", ["viewers/sher3.rviz", "viewers/foxglove.json"]),
    ],
    install_requires=["setuptools"],
    extras_require={"test": ["pytest"]},
    zip_safe=False,
    description="The robot seen: its scene, a recording as one page, and the running robot in a browser",
    license="Apache-2.0",
    entry_points={"console_scripts": []},
)
