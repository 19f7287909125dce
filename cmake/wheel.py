"""Builds a wheel of the Python package with CMake, for ``pip install .``: what pyproject.toml calls.

It compiles in build/wheel, so that a second time takes seconds, and needs the Debian packages of cmake/install_packages.sh.
Source: PEP 517 (build backends), PEP 427 (wheels), PEP 621 (metadata).
"""

from __future__ import annotations

import base64
import hashlib
import os
import re
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from pathlib import Path
from typing import Any

try:
    import tomllib
except ModuleNotFoundError:  # before Python 3.11
    import pip._vendor.tomli as tomllib

SOURCE = Path(__file__).resolve().parents[1]


def build_wheel(
    wheel_directory: str, config_settings: dict[str, Any] | None = None, metadata_directory: str | None = None
) -> str:
    """Builds kinecal-VERSION-TAG.whl in a folder; its name."""
    project = tomllib.loads((SOURCE / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    cmake = (SOURCE / "CMakeLists.txt").read_text(encoding="utf-8")
    project["version"] = re.search(r"project\(kinecal VERSION ([0-9.]+)", cmake)[1]
    stem = f"{project['name']}-{project['version']}"
    tag = _tag()
    with tempfile.TemporaryDirectory() as name:
        prefix = Path(name)
        _build(prefix)
        files = {
            file.relative_to(prefix).as_posix(): file
            for file in sorted((prefix / "kinecal").rglob("*"))
            if file.is_file()
        }
        texts = _metadata(project, f"{stem}.dist-info", tag)
        wheel = f"{stem}-{tag}.whl"
        _write(Path(wheel_directory) / wheel, files, texts, f"{stem}.dist-info/RECORD")
    return wheel


def _build(prefix: Path) -> None:
    """Compiles and installs module, sources and program into a folder."""
    build = SOURCE / "build" / "wheel"
    options = {
        "CMAKE_BUILD_TYPE": "Release",
        "CMAKE_CXX_COMPILER": os.environ.get("CXX", "g++"),  # of the presets, so that a compiler cache serves both
        "KINECAL_BUILD_TESTS": "OFF",
        "KINECAL_BUILD_BENCHMARKS": "OFF",
        "KINECAL_PYTHON": "ON",
        "KINECAL_PYTHON_FOLDER": ".",
        "Python_EXECUTABLE": sys.executable,
    }
    words = [f"-D{name}={value}" for name, value in options.items()]
    subprocess.run(["cmake", "-S", SOURCE, "-B", build, "-G", "Ninja", *words], check=True)
    subprocess.run(["cmake", "--build", build, "--target", "kinecal_python", "kinecal_program"], check=True)
    subprocess.run(["cmake", "--install", build, "--prefix", prefix, "--component", "python", "--strip"], check=True)
    program = prefix / "kinecal" / "bin" / "kinecal"
    program.parent.mkdir()
    program.write_bytes((build / "bin" / "kinecal").read_bytes())
    program.chmod(0o755)


def _tag() -> str:
    version = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    return f"{version}-{version}-{platform}"


def _metadata(project: dict[str, Any], folder: str, tag: str) -> dict[str, str]:
    lines = [
        "Metadata-Version: 2.1",
        f"Name: {project['name']}",
        f"Version: {project['version']}",
        f"Summary: {project['description']}",
        f"License: {project['license']['text']}",
        f"Requires-Python: {project['requires-python']}",
        *(f"Requires-Dist: {needed}" for needed in project["dependencies"]),
        "Description-Content-Type: text/markdown",
        "",
        (SOURCE / project["readme"]).read_text(encoding="utf-8"),
    ]
    scripts = [f"{name} = {function}" for name, function in project["scripts"].items()]
    return {
        f"{folder}/METADATA": "\n".join(lines),
        f"{folder}/WHEEL": f"Wheel-Version: 1.0\nGenerator: kinecal\nRoot-Is-Purelib: false\nTag: {tag}\n",
        f"{folder}/entry_points.txt": "\n".join(["[console_scripts]", *scripts, ""]),
    }


def _write(wheel: Path, files: dict[str, Path], texts: dict[str, str], record: str) -> None:
    """Writes the archive, with the checksum of each file."""
    contents = {name: (file.read_bytes(), file.stat().st_mode) for name, file in files.items()}
    contents.update({name: (text.encode(), 0o644) for name, text in texts.items()})
    rows = []
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, (content, mode) in contents.items():
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            rows.append(f"{name},sha256={digest},{len(content)}")
            entry = zipfile.ZipInfo(name)
            entry.external_attr = (mode & 0o777 | 0o100000) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, content)
        archive.writestr(record, "\n".join([*rows, f"{record},,", ""]))


if __name__ == "__main__":
    print(build_wheel(os.getcwd()))
