"""Checks the output of script/sbom for a build: its form, and libraries that the program is known to use.

  bill_of_materials_test.py SCRIPT BUILD
"""
import json
import re
import shutil
import subprocess
import sys


def main():
    if not shutil.which("dpkg-query"):
        print("SKIPPED: the packages are those of dpkg, which is missing")
        sys.exit(77)
    script, build = sys.argv[1:]
    document = json.loads(subprocess.run([script, "--build", build], capture_output=True, text=True, check=True).stdout)
    packages = {package["name"]: package for package in document["packages"]}
    ids = [package["SPDXID"] for package in document["packages"]]
    assert document["spdxVersion"] == "SPDX-2.3" and document["documentNamespace"].startswith("https://")
    assert len(set(ids)) == len(ids), "two packages with one identifier"
    assert all(re.fullmatch(r"SPDXRef-[A-Za-z0-9.-]+", identifier) for identifier in ids), ids
    known = set(ids) | {"SPDXRef-DOCUMENT"}
    for relation in document["relationships"]:
        assert relation["spdxElementId"] in known and relation["relatedSpdxElement"] in known, relation
    related = {relation["relatedSpdxElement"]: relation["relationshipType"] for relation in document["relationships"]
               if relation["spdxElementId"] == "SPDXRef-slalom"}
    assert related["SPDXRef-uplot"] == related["SPDXRef-fflate"] == "CONTAINS"
    assert len(packages["uplot"]["checksums"][0]["checksumValue"]) == 128
    dynamic = {identifier for identifier, kind in related.items() if kind == "DYNAMIC_LINK"}
    for prefix in ("SPDXRef-libc6", "SPDXRef-libyaml-cpp", "SPDXRef-libpng", "SPDXRef-libcairo"):
        assert any(identifier.startswith(prefix) for identifier in dynamic), f"{prefix} is not among {sorted(dynamic)}"
    for header_only in ("nlohmann-json3-dev", "libcli11-dev"):
        assert packages[header_only]["versionInfo"], header_only
    print(f"{len(packages)} packages")


if __name__ == "__main__":
    main()
