"""Build of sher3_bringup for colcon; the root pyproject.toml installs every package with pip."""

from setuptools import find_packages, setup

NAME = "sher3_bringup"

setup(
    name=NAME,
    version="0.1.0",
    packages=find_packages(exclude=["test"]),
    package_data={"": ["**/*.yaml", "**/*.xml", "py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
    ],
    install_requires=["setuptools"],
    extras_require={"test": ["pytest"]},
    zip_safe=False,
    description="Processes, nodes and settings of a run of the SHER 3.0",
    license="Apache-2.0",
)
