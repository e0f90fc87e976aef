# SPDX-License-Identifier: Apache-2.0
"""Visitors of disparity-web: the live page, a Foxglove viewer and an MJPEG stream, each a thread that reads as fast as it can."""
import base64
import json
import os
import socket
import struct
import threading
import time

from children import PATIENCE_S, Failure, wait_for


def end_connection(connection):
    """Closes it. A thread that reads hears of a shutdown, not of a close."""
    try:
        connection.shutdown(socket.SHUT_RDWR)
    except OSError:
        pass  # the server was first
    connection.close()


class WebSocket:
    """The client's side, without extensions."""

    def __init__(self, port, protocol):
        self._socket = socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S)
        key = base64.b64encode(os.urandom(16)).decode()
        self._socket.sendall((f"GET /live HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                              f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n"
                              f"Sec-WebSocket-Protocol: {protocol}\r\n\r\n").encode())
        self._file = self._socket.makefile("rb")
        first = self._file.readline()
        if b" 101 " not in first:
            raise Failure(f"disparity-web refuses a WebSocket: {first!r}")
        while self._file.readline() != b"\r\n":
            pass

    def send(self, message, operation=1):
        body = message if isinstance(message, bytes) else json.dumps(message).encode()
        length = bytes([0x80 | len(body)]) if len(body) < 126 else b"\xfe" + struct.pack(">H", len(body))
        # A mask of zeros leaves the bytes as they are.
        self._socket.sendall(bytes([0x80 | operation]) + length + bytes(4) + body)

    def _exactly(self, count):
        got = self._file.read(count)
        if len(got) != count:
            raise EOFError
        return got

    def message(self):
        """Returns whether the next message is text, and its bytes. Raises EOFError at the end."""
        while True:
            operation, length = self._exactly(2)
            if length == 126:
                length = struct.unpack(">H", self._exactly(2))[0]
            elif length == 127:
                length = struct.unpack(">Q", self._exactly(8))[0]
            body = self._exactly(length)
            operation &= 15
            if operation == 8:
                raise EOFError
            if operation == 9:
                self.send(body, 10)
            elif operation in (1, 2):
                return operation == 1, body

    def close(self):
        end_connection(self._socket)


class WebVisitor:
    """A thread that reads until it is told to leave. What it finds wrong is `trouble`."""

    def __init__(self, web):
        self.web = web
        self.frames = 0
        self.trouble = ""
        self.ages_ms = []
        self._leaving = False
        self._thread = threading.Thread(target=self._run, daemon=True)
        self.open()
        self._thread.start()
        self.wait_for_frame()

    def _run(self):
        try:
            self.read()
        except (OSError, EOFError) as error:
            if not self._leaving:
                self.trouble = f"the connection has ended: {error!r}"
        except Exception as error:  # whatever is wrong with a message
            self.trouble = repr(error)

    def wait_for_frame(self):
        before = self.frames
        wait_for(f"a frame for {type(self).__name__}", lambda: self.frames > before or self.trouble)

    def leave(self):
        """Goes when it has seen one more frame, and returns its account."""
        if not self.trouble:
            self.wait_for_frame()
        self.vanish()
        if self.trouble:
            raise Failure(f"{type(self).__name__}: {self.trouble}")
        ages = sorted(self.ages_ms)
        return {"frames": self.frames, "age_ms": [ages[(len(ages) - 1) * percent // 100] for percent in (50, 99, 100)] if ages else []}

    def vanish(self):
        """Goes at once."""
        self._leaving = True
        self.close()
        self._thread.join(PATIENCE_S)


class Page(WebVisitor):
    """Behaves as the page does, without drawing."""

    subscription = {"type": "subscribe", "images": ["left", "disparity"], "encoding": "jpeg", "max_width": 640, "max_rate": 0,
                    "range_m": None, "cloud_step": 4, "scan": True, "sensors": True}

    def open(self):
        self._link = WebSocket(self.web.port, "disparityd.live.v1")
        self._link.send(self.subscription)
        self._link.send({"type": "point", "x": 20, "y": 20})
        self.close = self._link.close
        self._last = None

    def read(self):
        while True:
            text, message = self._link.message()
            if text:
                told = json.loads(message)
                if told["type"] == "error":
                    raise ValueError(told["error"])
                continue
            length = struct.unpack("<I", message[:4])[0]
            self._frame(json.loads(message[4:4 + length]), len(message) - 4 - length)

    def _frame(self, header, payload):
        index = header["publish_index"]
        end = max([part["offset"] + part["bytes"] for part in [*header["images"], header.get("cloud")] if part], default=0)
        if end != payload:
            raise ValueError(f"frame {index} has {payload} bytes behind its header, which speaks of {end}")
        if self._last is not None and index < self._last + 1 + header["skipped"]:
            raise ValueError(f"frame {index} with {header['skipped']} skipped came after {self._last}")
        self._last = index
        self.ages_ms.append(header["age_ms"])
        self._link.send({"type": "seen", "publish_index": index})
        self.frames += 1


class LosslessPage(Page):
    """Wants values, no pictures, and few of them."""

    subscription = {"type": "subscribe", "images": ["disparity", "confidence"], "encoding": "lossless", "max_width": 0, "max_rate": 3}


class Viewer(WebVisitor):
    """Subscribes to every channel that Foxglove's protocol offers it."""

    def open(self):
        self._link = WebSocket(self.web.port, "foxglove.sdk.v1")
        self.close = self._link.close

    def read(self):
        subscription = 0
        while True:
            text, message = self._link.message()
            if not text:
                self.frames += 1
                continue
            told = json.loads(message)
            if told["op"] == "advertise":
                items = []
                for channel in told["channels"]:
                    subscription += 1
                    items.append({"id": subscription, "channelId": channel["id"]})
                self._link.send({"op": "subscribe", "subscriptions": items})
            elif told["op"] == "status" and told["level"] > 1:
                raise ValueError(told["message"])


class Stream(WebVisitor):
    """Reads the MJPEG stream."""

    def open(self):
        self._socket = socket.create_connection(("127.0.0.1", self.web.port), timeout=PATIENCE_S)
        self._socket.sendall(b"GET /stream.mjpg?image=disparity&width=80 HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
        self._file = self._socket.makefile("rb")

    def close(self):
        end_connection(self._socket)

    def read(self):
        if b" 200 " not in self._file.readline():
            raise ValueError("no stream")
        while True:
            line = self._file.readline()
            if not line:
                raise EOFError
            name, _, value = line.partition(b":")
            if name.lower() == b"content-length":
                while self._file.readline() not in (b"\r\n", b""):
                    pass
                picture = self._file.read(int(value))
                if not picture.startswith(b"\xff\xd8") or not picture.endswith(b"\xff\xd9"):
                    raise EOFError if len(picture) < int(value) else ValueError("a part is no JPEG")
                self.frames += 1


class Silent:
    """Opens a connection, sends half a request, and waits."""

    def __init__(self, web):
        self._socket = socket.create_connection(("127.0.0.1", web.port), timeout=PATIENCE_S)
        self._socket.sendall(b"GET / HTTP/1.1\r\nHost: 127")
        self._began = time.monotonic()

    def leave(self):
        self.vanish()
        return {"frames": 0, "age_ms": []}

    def vanish(self):
        self._socket.close()
