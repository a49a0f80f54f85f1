"""Build of sher3_cli for colcon; the root pyproject.toml installs every package with pip."""

from setuptools import find_packages, setup

NAME = "sher3_cli"

setup(
    name=NAME,
    version="0.2.0",
    packages=find_packages(exclude=["test"]),
    package_data={"": ["*.yaml", "*.xml", "*.html", "*.css", "*.json", "*.csv", "py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
    ],
    install_requires=["setuptools"],
    extras_require={"test": ["pytest"]},
    zip_safe=False,
    description="The sher3 command",
    license="Apache-2.0",
    entry_points={"console_scripts": ["sher3 = sher3_cli.__main__:main"]},
)
