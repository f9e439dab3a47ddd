#!/usr/bin/python3
"""Checks that ament takes each package.xml of the ROS 2 packages.

usage: package_files_test.py FILE...

Exits with 77 and a message where Debian's python3-catkin-pkg is not installed.
"""

import sys

try:
    from catkin_pkg.package import parse_package
except ImportError:
    print("skipped: catkin_pkg is not installed (apt-get install python3-catkin-pkg)")
    sys.exit(77)

if len(sys.argv) < 2:
    sys.exit(__doc__)
for path in sys.argv[1:]:
    warnings = []
    package = parse_package(path, warnings=warnings)  # throws InvalidPackage with the rule
    if warnings:
        sys.exit(f"{path}: " + "; ".join(warnings))
    print(f"{path}: {package.name} {package.version}")
