"""Build of sher3_chain for colcon; the root pyproject.toml installs every package with pip."""

from setuptools import find_packages, setup

NAME = "sher3_chain"

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
    description="Chains of joints as machines of the diagnosis: axes, and serial arms in motion",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [],
        "sher3.kinds": ["axes = sher3_chain.axes.kind:KIND", "manipulator = sher3_chain.manipulator.kind:KIND"],
    },
)
