# SPDX-License-Identifier: Apache-2.0
"""pip builds and installs the Python client, from a checkout and from its source archive; what it installed reads frames.

Usage: python_package_test.py SOURCE DISPARITYD FOLDER-OF-THE-CLIENT-LIBRARY. Nothing is taken from the network. Exit status 77
where a Python module or protoc is missing, said on standard output.
"""
import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import zipfile

SOURCE, DISPARITYD, LIBRARY_FOLDER = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
SKIP = 77

# Reads a frame in each way and says what it is.
READ_FRAMES = """
import disparity, importlib.metadata, pathlib, sys
address, name = sys.argv[1:]
print("version", importlib.metadata.version("disparity"))
folder = pathlib.Path(disparity.__file__).parent
print("in the venv", sys.prefix in str(folder), sorted(path.name for path in folder.iterdir() if path.is_file()))
with disparity.SocketClient(address) as client:
    client.subscribe([disparity.DISPARITY, disparity.DEPTH])
    frame = client.read(timeout=20)
    print("socket", frame.depth.shape, frame.depth.dtype, client.status().server_version)
try:
    with disparity.SharedMemoryReader(name) as reader:
        print("shared memory", reader.read(timeout=20).depth.shape)
except disparity.DisparityError as error:
    print("shared memory:", error)
"""


def project_version():
    return re.search(r"^project\(disparityd VERSION (\S+)", (SOURCE / "CMakeLists.txt").read_text(), re.MULTILINE)[1]


def run(*command, **options):
    """Returns what the command printed; the text of an error has all of it."""
    environment = {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "PIP_", "DISPARITY"))}
    environment.update(options.pop("environment", {}))
    made = subprocess.run([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=120,
                          env=environment, check=False, **options)
    if made.returncode != 0:
        raise RuntimeError(f"{command}: exit status {made.returncode}:\n{made.stdout}")
    return made.stdout


def pip(python, *arguments):
    return run(python, "-m", "pip", "--disable-pip-version-check", "--no-cache-dir", *arguments)


class PythonPackage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = pathlib.Path(temporary.name)
        # A copy of what the package is made of: pip builds in its place.
        cls.checkout = cls.folder / "checkout"
        (cls.checkout / "proto").mkdir(parents=True)
        shutil.copy(SOURCE / "CMakeLists.txt", cls.checkout)
        shutil.copy(SOURCE / "proto" / "disparity.proto", cls.checkout / "proto")
        shutil.copytree(SOURCE / "clients" / "python", cls.checkout / "clients" / "python",
                        ignore=shutil.ignore_patterns("__pycache__", "build", "*.egg-info", "disparity_pb2.*"))
        cls.package = cls.checkout / "clients" / "python"
        run(sys.executable, "-m", "venv", "--system-site-packages", "--without-pip", cls.folder / "venv")
        cls.python = cls.folder / "venv" / "bin" / "python"
        pip(cls.python, "install", "--no-index", "--no-build-isolation", cls.package)

    def start_daemon(self):
        """Starts a daemon on the rendered scene. Returns (address, name of its shared memory)."""
        name = f"python-package-{os.getpid()}"
        daemon = subprocess.Popen(
            [DISPARITYD, "--source", "scene:vga@15?width=320&height=180", "--name", name, "--print-address", "--set",
             "socket.tcp=127.0.0.1:0", "--set", "socket.unix=", "--set", "match.disparities=32"], stdout=subprocess.PIPE, text=True)
        self.addCleanup(daemon.stdout.close)
        self.addCleanup(daemon.wait)
        self.addCleanup(daemon.terminate)
        addresses = []
        for line in daemon.stdout:
            if line.strip() == "ready":
                break
            addresses.append(line.strip())
        return next(address for address in addresses if address.startswith("tcp:")), name

    def test_what_pip_installed_reads_frames(self):
        address, name = self.start_daemon()
        command = [self.python, "-I", "-c", READ_FRAMES, address, name]
        said = run(*command, environment={"LD_LIBRARY_PATH": str(LIBRARY_FOLDER)}, cwd=self.folder)
        self.assertIn(f"version {project_version()}\n", said)
        self.assertIn("in the venv True", said)
        for file in ("disparity_pb2.py", "py.typed"):
            self.assertIn(f"'{file}'", said)
        self.assertIn(f"socket (180, 320) uint16 {project_version()}", said)
        self.assertIn("shared memory (180, 320)\n", said)

        if "libdisparity-client.so.0" in run("/sbin/ldconfig", "-p"):
            return  # this machine has the library
        said = run(*command, cwd=self.folder)
        self.assertIn("socket (180, 320)", said)
        self.assertRegex(said, r"shared memory: libdisparity-client\.so\.0 cannot be loaded \(.*\): install it .*\n$")

    def test_the_wheel_is_pure_and_the_same_from_the_source_archive(self):
        out = self.folder / "out"
        pip(sys.executable, "wheel", "--no-index", "--no-build-isolation", "--no-deps", "-w", out / "checkout", self.package)
        run(sys.executable, "-c", "import setuptools.build_meta as b, sys; b.build_sdist(sys.argv[1])", out, cwd=self.package)
        archive = out / f"disparity-{project_version()}.tar.gz"
        pip(sys.executable, "wheel", "--no-index", "--no-build-isolation", "--no-deps", "-w", out / "archive", archive)
        wheel = f"disparity-{project_version()}-py3-none-any.whl"
        files = {}
        for origin in ("checkout", "archive"):
            with zipfile.ZipFile(out / origin / wheel) as opened:
                files[origin] = {name: opened.read(name) for name in opened.namelist()}
        self.assertEqual(files["checkout"], files["archive"])
        self.assertIn("disparity/disparity_pb2.py", files["checkout"])
        self.assertIn("disparity/py.typed", files["checkout"])

    def test_an_editable_installation_has_the_messages_in_its_source(self):
        run(sys.executable, "-m", "venv", "--system-site-packages", "--without-pip", self.folder / "editable")
        python = self.folder / "editable" / "bin" / "python"
        pip(python, "install", "--no-index", "--no-build-isolation", "-e", self.package)
        said = run(python, "-I", "-c", "import disparity; print(disparity.__file__)", cwd=self.folder)
        self.assertEqual(said.strip(), str(self.package / "disparity" / "__init__.py"))
        (self.package / "disparity" / "disparity_pb2.py").unlink()

    def test_the_needed_protobuf_is_that_of_protoc(self):
        made = {
            "_message.FileDescriptor(serialized_pb=b'')": "protobuf<4,>=3.12",
            "from google.protobuf.internal import builder as _builder": "protobuf>=3.20",
            "_runtime_version.ValidateProtobufRuntimeVersion(\n    _runtime_version.Domain.PUBLIC,\n    5,\n    29,\n    1,\n    '',":
                "protobuf>=5.29.1",
        }
        for text, needed in made.items():
            # An old one: it knows no --pyi_out.
            protoc = self.folder / "protoc"
            protoc.write_text("#!/bin/sh\nfor one; do case $one in --python_out=*) out=${one#*=} ;; --pyi_out=*) exit 1 ;; esac; done\n"
                              f'[ "$1" = --help ] || cat >"$out/disparity_pb2.py" <<"END"\n{text}\nEND\n', encoding="utf-8")
            protoc.chmod(0o755)
            run(sys.executable, "-B", "setup.py", "--quiet", "egg_info", "--egg-base", self.folder, cwd=self.package,
                environment={"PROTOC": str(protoc)})
            required = (self.folder / "disparity.egg-info" / "requires.txt").read_text(encoding="utf-8")
            self.assertIn(f"\n{needed}\n", "\n" + required)

    def refusal(self, folder, **environment):
        with self.assertRaises(RuntimeError) as caught:
            run(sys.executable, "-B", "setup.py", "--version", cwd=folder, environment=environment)
        return str(caught.exception).partition(":\n")[2]

    def test_what_is_missing_is_said_in_one_line(self):
        self.assertRegex(self.refusal(self.package, PATH="/nonexistent", PROTOC=""),
                         r"\Aerror: protoc: not found in PATH, .*install Debian's protobuf-compiler and libprotobuf-dev, or set PROTOC to its path\n\Z")
        alone = self.folder / "alone" / "deep" / "down"
        shutil.copytree(self.package, alone)
        shutil.copytree(self.checkout / "proto", self.folder / "alone" / "proto")
        self.assertRegex(self.refusal(alone), r"\Aerror: .*/alone/CMakeLists.txt: found no version, expected the project's: .*\n\Z")


def main():
    missing = [name for name in ("pip", "setuptools", "wheel", "venv", "numpy", "google.protobuf")
               if importlib.util.find_spec(name.partition(".")[0]) is None]
    if not shutil.which("protoc"):
        missing.append("protoc")
    if missing:
        print(f"skipped: {sys.executable} has no {', '.join(missing)}")
        return SKIP
    unittest.main(argv=sys.argv[:1])
    return 0


if __name__ == "__main__":
    sys.exit(main())
