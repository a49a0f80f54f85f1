"""Build of sher3_bringup for colcon; the root pyproject.toml installs every package with pip."""

from setuptools import find_packages, setup

NAME = "sher3_bringup"
NODES = (
    "plant", "force_sensor", "pedal", "admittance", "kinematics", "motor_driver", "supervisor",
    "recorder", "gap_monitor",
)  # fmt: skip

setup(
    name=NAME,
    version="0.2.0",
    packages=find_packages(exclude=["test"]),
    package_data={"": ["**/*.yaml", "**/*.xml", "py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        (f"share/{NAME}/launch", ["launch/sher3.launch.py", "launch/nodes.launch.py"]),
    ],
    install_requires=["setuptools"],
    extras_require={"test": ["pytest"]},
    zip_safe=False,
    description="Processes, nodes and settings of a run of the SHER 3.0",
    license="Apache-2.0",
    entry_points={"console_scripts": [f"{node} = sher3_bringup.processes.one_node:main" for node in NODES]},
)
