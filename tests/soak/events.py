# SPDX-License-Identifier: Apache-2.0
"""What happens to a daemon: configurations, faults of the camera, full disks, disparity-web killed. After each the daemon runs."""
import json
import resource
import shutil
import signal
import subprocess

from children import Child, Failure, wait_for


def reload(course, daemon):
    """Another configuration, of any kind; clients stay connected."""
    choose = course.random.choice
    width, height = choose([(160, 88), (96, 64), (320, 176)])
    daemon.reload_and_run({
        "rectify.width": width, "rectify.height": height, "rectify.colour": choose([True, False]),
        "match.method": choose(["census", "sad", "sgm"]), "match.disparities": choose([32, 64]),
        "match.depth_error": choose([True, False]), "scan.enabled": choose([True, False]), "pipeline.slots": choose([2, 4, 5]),
        "pipeline.workers": choose([1, 2]), "shared_memory.slots": choose([2, 4, 6]), "socket.client_queue": choose([1, 4, 6]),
        "record.max_mb": choose([0, 1000])})


def wrong_reload(course, daemon):
    """A configuration that is refused; the one before goes on."""
    text, changes = course.random.choice([
        ("[match]\ndisparities = 33\n", {}), ("this is no TOML", {}), ("[unknown]\nkey = 1\n", {}), ("\0\1\2", {}),
        (None, {"source.uri": str(daemon.folder / "missing.mkv")}), (None, {"source.uri": "nonsense:1"}),
        (None, {"rectify.region": [0, 0, 9000, 10]})])
    if daemon.reload(changes, text):
        raise Failure(f"{daemon.child.name} takes {text or changes}")
    daemon.write_config({})
    daemon.wait_until_running()


def several_reloads(course, daemon):
    """Signals that come faster than configurations can be loaded."""
    daemon.write_config({"rectify.width": 96, "rectify.height": 64})
    for _ in range(course.random.randint(2, 5)):
        daemon.child.send(signal.SIGHUP)
    daemon.reload_and_run({})
    # One that is still on its way loads the same file.
    wait_for(f"{daemon.child.name}: the last configuration", lambda: daemon.status()["geometry"]["width"] == 160)
    daemon.wait_until_running()


def camera_away(course, daemon):
    """The source is a camera that is not plugged in, and then the one before again."""
    if not daemon.reload({"source.uri": "v4l2:vga@30?serial=1"}):
        raise Failure(f"{daemon.child.name} does not wait for a camera: {daemon.child.last_words()}")
    daemon.wait_for_state("waiting")
    daemon.faults += 1
    daemon.reload_and_run({})


def recording_ends(course, daemon):
    """A recording that is played once. Nothing is under way then: each frame must be accounted for."""
    if not daemon.reload({"source.uri": str(course.recording), "source.loop": False, "source.pace": "fastest"}):
        raise Failure(f"{daemon.child.name} does not play {course.recording}: {daemon.child.last_words()}")
    daemon.wait_for_state("ended")
    daemon.faults += 1
    course.check_ended_pipeline(daemon)
    daemon.reload_and_run({})


def recording_is_cut(course, daemon):
    """The recording that is played is cut, overwritten or removed under the daemon's hands."""
    played = daemon.folder / "damaged.mkv"
    shutil.copy(course.recording, played)
    daemon.reload_and_run({"source.uri": str(played)})
    manner = course.random.choice(["cut", "overwritten", "removed"])
    size = played.stat().st_size
    if manner == "removed":
        played.unlink()
    else:
        with played.open("r+b") as file:
            if manner == "cut":
                file.truncate(course.random.randrange(size))
            else:
                file.seek(course.random.randrange(size // 2))
                file.write(course.random.randbytes(size // 4))

    def played_on():
        status = daemon.status()
        return status["state"] == "ended" or status["published"] > 1.5 * course.recorded_frames
    # Whether it finds what is left to be enough for another round is its own affair.
    wait_for(f"{daemon.child.name}: the end of a recording that was {manner}", played_on)
    daemon.faults += 1
    daemon.reload_and_run({})
    played.unlink(missing_ok=True)


def record(course, daemon):
    """A recording as a user makes it."""
    name = f"run-{course.next_number()}.mkv"
    done = daemon.control("record", name, "--frames", "8", "--json")
    if done.returncode != 0:
        raise Failure(f"disparityctl record ended with {done.returncode}: {done.stderr.strip()}")
    said = json.loads(done.stdout)
    if said["frames"] < 8 or said["error"]:
        raise Failure(f"a recording of 8 frames: {said}")
    (daemon.recordings / name).unlink()


def recorder_is_killed(course, daemon):
    """Whoever asked for a recording is gone; somebody else ends it."""
    name = f"orphan-{course.next_number()}.mkv"
    recorder = Child("disparityctl record", [daemon.programs / "disparityctl", "record", name, "--socket", daemon.unix],
                     course.folder / "recorder-log")
    try:
        wait_for("a recorded frame", lambda: (now := daemon.status()["record"])["active"] and now["frames"] > 0)
    finally:
        recorder.kill()
    done = daemon.control("record", "--stop")
    if done.returncode != 0:
        raise Failure(f"disparityctl record --stop ended with {done.returncode}: {done.stderr.strip()}")
    (daemon.recordings / name).unlink()


def full_disk(course, daemon):
    """A recording that the disk has no room for. Frames go on."""
    if course.small_disk(daemon):
        name = f"small/full-{course.next_number()}.mkv"
    else:
        name = f"full-{course.next_number()}.mkv"
        limits = resource.prlimit(daemon.child.pid, resource.RLIMIT_FSIZE)
        resource.prlimit(daemon.child.pid, resource.RLIMIT_FSIZE, (2_000_000, limits[1]))
    done = daemon.control("record", name)
    if not course.small_disk(daemon):
        resource.prlimit(daemon.child.pid, resource.RLIMIT_FSIZE, limits)
    if done.returncode != 1 or not ("No space left" in done.stderr or "File too large" in done.stderr):
        raise Failure(f"a recording onto a full disk ended with {done.returncode}: {done.stdout.strip()} {done.stderr.strip()}")
    (daemon.recordings / name).unlink(missing_ok=True)  # without a frame it is removed
    daemon.wait_for_frames(2)


def trace(course, daemon):
    """A record of what the threads do."""
    out = course.folder / f"trace-{course.next_number()}.json"
    done = daemon.control("trace", "--seconds", "0.5", "-o", str(out))
    if done.returncode != 0:
        raise Failure(f"disparityctl trace ended with {done.returncode}: {done.stderr.strip()}")
    json.loads(out.read_text())
    out.unlink()


def requests(course, daemon):
    """What browsers and monitors ask disparity-web."""
    web = course.webs[daemon.name]
    for method, target, body, allowed in (
            ("GET", "/", None, {200}), ("GET", "/api/status", None, {200}), ("GET", "/metrics", None, {200}),
            ("GET", "/snapshot.png", None, {200, 409}), ("GET", "/snapshot.jpg?image=left", None, {200}),
            ("GET", "/snapshot.ply", None, {200, 409}), ("GET", "/nothing", None, {404}), ("GET", "/api/camera", None, {409}),
            ("POST", "/api/recording", '{"path": "../no.mkv"}', {409}), ("POST", "/api/recording", "[", {400})):
        status, _ = web.ask(method, target, body)
        if status not in allowed:
            raise Failure(f"{web.child.name}: {method} {target} answers {status}, expected {sorted(allowed)}")


def web_restarts(course, daemon):
    """disparity-web is killed or ended, and started again. The one beside the live daemon stays: its memory is looked at."""
    web = course.webs["replay"]
    course.end_web_visitors("replay")
    number = course.random.choice([signal.SIGTERM, signal.SIGINT, signal.SIGKILL])
    status = web.stop(number)
    if status != (-signal.SIGKILL if number == signal.SIGKILL else 0):
        raise Failure(f"{web.child.name} ended with {status}: {web.child.last_words()}")
    web.start()


def mount_small_disk(folder):
    """Mounts a disk of 2 MiB there. Returns whether the system lets this program do that."""
    folder.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=2m", "soak", str(folder)], capture_output=True, check=False)
    if mounted.returncode != 0:
        folder.rmdir()
    return mounted.returncode == 0


# How often each happens, against the others.
EVENTS = {reload: 6, wrong_reload: 3, several_reloads: 1, camera_away: 2, recording_ends: 2, recording_is_cut: 3, record: 3,
          recorder_is_killed: 2, full_disk: 3, trace: 1, requests: 4, web_restarts: 2}
