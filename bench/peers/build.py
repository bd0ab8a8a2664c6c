"""Gets the engines and builds the programs that measure them, all below build/peers; what cannot be had is told.

Wheels are unpacked by pip into a folder each, so that several versions stand side by side; only their headers and
libraries are used by the C++ programs. Pinocchio is compiled from its headers alone, like any program that uses it.
"""

import glob
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = ROOT / "build" / "peers"
SOURCES = ROOT / "bench" / "peers"

# Folder, what pip is asked for, more arguments. The last version with every interface of a series, as pip finds it.
WHEELS = [
    ("mujoco-4", "mujoco-core>=4,<5", []),  # since 4.0 apart from what is Python
    ("mujoco-3", "mujoco>=3.12,<4", []),
    ("mujoco-2", "mujoco==2.2.2", ["--only-binary=:all:", "--python-version", "3.10"]),  # no newer Python; not run by it
    ("pin-4", "pin>=4,<5", []),
    ("pin-3", "pin>=3.7,<4", []),
]
PYTHON_PACKAGES = ["numpy>=1.24,<3", "drake>=1.30,<2", "exudyn>=1.8,<2"]

BASE = ["-std=c++20", "-O3", "-DNDEBUG", "-w", f"-I{ROOT}"]
BASELINE = ["-march=x86-64-v2"]  # as ours
WIDER = ["-march=x86-64-v3"]  # what a user may add where the machine has it
BOOST = ["-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30", "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
         "-DBOOST_FUSION_INVOKE_MAX_ARITY=12"]


def venv_python():
    return FOLDER / "venv" / "bin" / "python"


def run(command, **options):
    return subprocess.run([str(c) for c in command], capture_output=True, text=True, **options)


def get_packages(problems):
    if not venv_python().exists():
        run([sys.executable, "-m", "venv", FOLDER / "venv"], check=True)
    pip = [venv_python(), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    for package in PYTHON_PACKAGES:
        name = package.split(">")[0]
        if run([venv_python(), "-c", f"import {'pydrake' if name == 'drake' else name}"]).returncode == 0:
            continue
        done = run([*pip, package])
        if done.returncode:
            problems[name] = "not installed: " + last_line(done.stderr)
    for folder, package, arguments in WHEELS:
        if (FOLDER / folder).exists():
            continue
        no_deps = [] if package.startswith("pin") else ["--no-deps"]
        done = run([*pip, *no_deps, *arguments, "--target", FOLDER / folder, package])
        if done.returncode:
            problems[folder] = "not installed: " + last_line(done.stderr)


def last_line(text):
    lines = text.strip().splitlines()
    return lines[-1] if lines else "no message"


def compile_program(name, source, flags, libraries, problems):
    program = FOLDER / "bin" / name
    newest = max(os.path.getmtime(SOURCES / f) for f in (source, "scene.h"))
    if program.exists() and program.stat().st_mtime >= newest:
        return
    program.parent.mkdir(parents=True, exist_ok=True)
    done = run([os.environ.get("CXX", "g++"), *flags, SOURCES / source, *libraries, "-o", program])
    if done.returncode:
        errors = [line for line in done.stderr.splitlines() if "error" in line]
        problems[name] = "does not compile: " + (errors[0] if errors else last_line(done.stderr))


def has_wider():
    try:
        return "avx2" in pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return False


def build_programs(problems):
    """The names of the programs built, with what is wrong with the others in `problems`."""
    compile_program("floor_peer", "floor_peer.cc", [*BASE, *BASELINE], [], problems)
    # Simbody's headers hold checks that its library, as Debian builds it, expects.
    simbody = [f for f in BASE if f != "-DNDEBUG" and not f.startswith("-std")]
    if pathlib.Path("/usr/include/simbody/Simbody.h").exists():
        compile_program("simbody_peer", "simbody_peer.cc", ["-std=c++17", *simbody, *BASELINE, "-I/usr/include/simbody"],
                        ["-lSimTKsimbody", "-lSimTKmath", "-lSimTKcommon"], problems)
    else:
        problems["simbody_peer"] = "libsimbody-dev is not installed"
    for series in ("4", "3", "2"):
        place = FOLDER / f"mujoco-{series}" / "mujoco"
        library = glob.glob(str(place / "libmujoco.so*"))
        if library:
            compile_program(f"mujoco_peer_{series}", "mujoco_peer.cc", [*BASE, *BASELINE, f"-I{place / 'include'}"],
                            [library[0], f"-Wl,-rpath,{place}"], problems)
    for series in ("4", "3"):
        place = FOLDER / f"pin-{series}" / "cmeel.prefix" / "include"
        flags = [*BASE, *BOOST, f"-I{place}", "-I/usr/include/eigen3"]
        if place.exists():
            compile_program(f"pinocchio_peer_{series}", "pinocchio_peer.cc", [*flags, *BASELINE], [], problems)
            if series == "4" and has_wider():
                compile_program("pinocchio_peer_4_avx2", "pinocchio_peer.cc", [*flags, *WIDER], [], problems)


if __name__ == "__main__":
    found = {}
    get_packages(found)
    build_programs(found)
    for what, problem in found.items():
        print(f"{what}: {problem}")
