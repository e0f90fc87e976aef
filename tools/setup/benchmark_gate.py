# SPDX-License-Identifier: Apache-2.0
"""tools/benchmarks --against: measures an older commit and the working tree in alternation. See --help."""
import argparse
import contextlib
import fcntl
import functools
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys

import benchmark_verdict as verdict

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = ROOT / "build" / "against"
# Target, its arguments, and what reads its output. Both programs are as old as the oldest commit worth comparing with.
PROGRAMS = (
    ("cpu_kernels_check", ["--bench"], verdict.read_kernel_table),
    ("disparity-bench", ["--pair", "450x375x128", "--contestant", "cpu", "--no-roofline", "--json", "-"],
     verdict.read_frames),
)
# Both sides are compiled with these, whatever build/release is configured with.
OPTIONS = ["-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DDISPARITYD_CUDA=OFF", "-DDISPARITYD_TEST_PROGRAMS=ON"]
PATIENCE_S = 20  # for a program that was told to end


class Trouble(Exception):
    """One line for people."""


def run(command, **options):
    """subprocess.run() in a session of its own, all of which ends when this program is interrupted."""
    # An interrupt that came before Popen has returned would leave the program running, with nobody who knows it.
    before = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT, signal.SIGTERM))

    def listen_again():
        signal.pthread_sigmask(signal.SIG_SETMASK, before)

    try:
        process = subprocess.Popen(command, start_new_session=True, preexec_fn=listen_again, **options)
    except BaseException:
        listen_again()
        raise
    with process:
        try:
            listen_again()
            output, _ = process.communicate()
        except BaseException:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGTERM)
            try:
                process.wait(PATIENCE_S)
            except subprocess.TimeoutExpired:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(process.pid, signal.SIGKILL)
            raise
    return process.returncode, output


def git(*arguments):
    status, output = run(["git", "-C", str(ROOT), *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if status != 0:
        raise Trouble(f"git {arguments[0]}: {output.strip()}")
    return output.strip()


def resolve(name):
    try:
        return git("rev-parse", "--verify", "--quiet", "--end-of-options", f"{name}^{{commit}}")
    except Trouble:
        raise Trouble(f"--against: found '{name}', allowed: a commit, branch or tag of this repository") from None


@contextlib.contextmanager
def alone():
    """One comparison at a time: they share a folder."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    with open(FOLDER / "lock", "w", encoding="utf-8") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise Trouble("another comparison runs in build/against; wait for it") from None
        yield


def remove_checkout(checkout):
    if checkout.exists():
        shutil.rmtree(checkout)
    git("worktree", "prune")


@contextlib.contextmanager
def checkout_of(commit):
    """The commit's files, in a worktree of git that is removed in any case."""
    checkout = FOLDER / "source"
    remove_checkout(checkout)  # of a comparison that was killed
    try:
        git("worktree", "add", "--quiet", "--detach", str(checkout), commit)
        yield checkout
    finally:
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_IGN)
        remove_checkout(checkout)


def build(source, name):
    """{target: program} of those that this version has. Where ccache is, files that are alike are compiled once: both
    versions have their build folder at the same place below their sources."""
    folder = source / "build" / "against" / "programs"
    log = FOLDER / f"{name}.txt"
    environment = {**os.environ, "CCACHE_BASEDIR": str(source)}
    print(f"building {name} in {folder.relative_to(ROOT)}", flush=True)

    def step(*command):
        with open(log, "a", encoding="utf-8") as output:
            return run(command, stdout=output, stderr=subprocess.STDOUT, env=environment)[0]

    log.unlink(missing_ok=True)
    if step("cmake", "-S", str(source), "-B", str(folder), *OPTIONS) != 0:
        raise Trouble(f"{name}: configuring failed, see {log.relative_to(ROOT)}")
    _, known = run(["ninja", "-C", str(folder), "-t", "targets", "all"], stdout=subprocess.PIPE, text=True)
    targets = [target for target, _, _ in PROGRAMS if f"\n{target}: phony" in f"\n{known}"]
    if not targets or step("cmake", "--build", str(folder), "--target", *targets) != 0:
        raise Trouble(f"{name}: the build failed, see {log.relative_to(ROOT)}")
    return {target: folder / "bin" / target for target in targets}


def link_again(program, layout):
    """The program with code and constants at other addresses, which `layout` chooses. Where a loop begins can make a tenth of
    its time, so one layout of each side would compare their luck."""
    folder, target = program.parent.parent, program.name
    _, commands = run(["ninja", "-C", str(folder), "-t", "commands", target], stdout=subprocess.PIPE, text=True)
    shifted = program.with_name(f"{target}-shifted")
    assembly, obj = shifted.with_suffix(".s"), shifted.with_suffix(".o")
    # Functions begin at multiples of 16 bytes, tables of vectors at multiples of 64.
    sections = (".text", 16), (".rodata", 64), (".data", 64)
    skips = "".join(f".section {name}\n.skip {step * layout.randrange(4096 // step)}\n" for name, step in sections)
    assembly.write_text(f'{skips}.section .note.GNU-stack,"",%progbits\n', encoding="utf-8")
    link = commands.splitlines()[-1].replace(f" -o bin/{target} ", f" -o {shifted} {obj} ", 1)
    if str(shifted) not in link:  # no linker made it
        return program
    if run(["sh", "-c", f"${{CC:-cc}} -c {assembly} -o {obj} && {link}"], cwd=folder)[0] != 0:
        raise Trouble(f"{program.relative_to(ROOT)} cannot be linked again")
    return shifted


def measure(program, arguments, read, wanted, layout):
    """The kernels of one side whose names contain the text; each time with another layout."""
    command = [str(link_again(program, layout)), *arguments]
    if arguments == ["--bench"] and "/" in wanted:  # cpu_kernels_check need not measure the others
        command.append(wanted.split()[0])
    status, output = run(command, stdout=subprocess.PIPE, text=True)
    if status != 0:
        raise Trouble(f"{program.relative_to(ROOT)} ended with exit status {status}")
    return {kernel: time for kernel, time in read(output).items() if wanted in kernel}


def alternate(before, after, rounds):
    """A pair of measurements for each round; who comes first changes from round to round."""
    pairs = []
    for number in range(rounds):
        print(f"round {number + 1} of {rounds}", flush=True)
        if number % 2 == 0:
            old = before()
            new = after()
        else:
            new = after()
            old = before()
        pairs.append((old, new))
        if not old and not new:  # nothing of this program is wanted
            break
    return pairs


def compare(arguments):
    commit = resolve(arguments.against)
    rows = []
    with alone(), checkout_of(commit) as checkout:
        programs = {"before": build(checkout, "before"), "after": build(ROOT, "after")}
        for target, options, read in PROGRAMS:
            missing = [side for side, built in programs.items() if target not in built]
            if missing:
                print(f"{target} is left out: there is none in {' and '.join(missing)}")
                continue
            sides = [functools.partial(measure, built[target], options, read, arguments.kernels, random.Random(side))
                     for side, built in programs.items()]
            print(target)
            rows += verdict.judge(alternate(*sides, arguments.rounds))
    if not rows:
        raise Trouble(f"--kernels: found '{arguments.kernels}', which is in no kernel's name")
    return report(rows, commit, arguments)


def report(rows, commit, arguments):
    print(f"\nbefore: {commit[:10]}, after: the working tree; medians of {arguments.rounds} rounds, ns per pixel of kernels, "
          "ms of frames (cpu/...)\nratio: median of after / before in each round")
    print("\n".join(verdict.table(rows, arguments.limit)))
    bad = verdict.slower(rows, arguments.limit)
    judged = sum(row.ratio is not None for row in rows)
    print(f"{len(bad)} of {judged} are more than {arguments.limit:g} % slower" + (":" if bad else ""))
    for row in bad:
        print(f"  {row.kernel}: {100 * (row.ratio - 1):.1f} %")
    return 1 if bad else 0


def whole_number(text):
    if not text.isascii() or not text.isdigit() or not 1 <= int(text) <= 1000:
        raise argparse.ArgumentTypeError(f"found '{text}', allowed: a whole number from 1 to 1000")
    return int(text)


def percent(text):
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0 <= value <= 1000:
        raise argparse.ArgumentTypeError(f"found '{text}', allowed: 0 to 1000")
    return value


def parse(words):
    parser = argparse.ArgumentParser(
        prog="tools/benchmarks", allow_abbrev=False, formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Builds COMMIT and the working tree alike, measures both in alternation, kernel by kernel, and fails "
                    "when a kernel\nhas become slower. Before each measurement the programs are linked anew with code at other "
                    "addresses.\nThe machine should do nothing else meanwhile.",
        epilog="Exit status: 0 no kernel is slower; 1 one is, or the build failed; 2 arguments must be changed; 130 Ctrl-C.\n"
               "example: tools/benchmarks --against main --kernels sweep")
    parser.add_argument("--against", required=True, metavar="COMMIT", help="commit, branch or tag to compare with")
    parser.add_argument("--rounds", type=whole_number, default=9, metavar="N", help="pairs of measurements (default 9)")
    parser.add_argument("--limit", type=percent, default=5.0, metavar="PERCENT",
                        help="how much slower a kernel may be, in the median of the pairs (default 5)")
    parser.add_argument("--kernels", default="", metavar="TEXT", help="only kernels with this text in their names")
    return parser.parse_args(words)


def interrupt(_number, _frame):
    raise KeyboardInterrupt


def main():
    arguments = parse(sys.argv[1:])
    signal.signal(signal.SIGTERM, interrupt)
    try:
        return compare(arguments)
    except Trouble as trouble:
        print(f"tools/benchmarks: error: {trouble}", file=sys.stderr)
        return 2 if str(trouble).startswith("--") else 1
    except KeyboardInterrupt:
        print("tools/benchmarks: interrupted; nothing is judged", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main())
