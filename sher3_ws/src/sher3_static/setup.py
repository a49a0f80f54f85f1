"""Build of sher3_static for colcon; the root pyproject.toml installs every package with pip."""

from setuptools import find_packages, setup

NAME = "sher3_static"

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
    description="Tables of readings under known conditions as machines of the diagnosis",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [],
        "sher3.kinds": [
            "arm = sher3_static.arm.kind:KIND",
            "force_sensor = sher3_static.sensor.kind:KIND",
            "load_cell = sher3_static.cell.kind:KIND",
            "positioning = sher3_static.positioning.kind:KIND",
        ],
    },
)
