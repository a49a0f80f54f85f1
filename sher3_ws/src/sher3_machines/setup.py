"""Build of sher3_machines for colcon; the root pyproject.toml installs every package with pip."""

from setuptools import find_packages, setup

NAME = "sher3_machines"

setup(
    name=NAME,
    version="0.2.0",
    packages=find_packages(exclude=["test"]),
    package_data={"": ["**/*.yaml", "**/*.xml", "py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
    ],
    install_requires=["setuptools"],
    extras_require={"test": ["pytest"]},
    zip_safe=False,
    description="Machines other than SHER, described in a few lines of YAML, for the diagnosis",
    license="Apache-2.0",
    entry_points={"console_scripts": []},
)
