# SPDX-License-Identifier: Apache-2.0
"""Prints three frames that the Python client reads over TLS, a line "INDEX PRODUCT HASH" for each plane.

tls_python_check.py ADDRESS AUTHORITY CERTIFICATE KEY TOKEN-FILE. Exit status 77: a Python module is missing.
"""
import os
import sys
import threading

try:
    import google.protobuf  # noqa: F401
    import numpy  # noqa: F401
except ImportError as error:
    print(f"skipped: {error}", file=sys.stderr)
    sys.exit(77)

import disparity


def fnv1a(data):
    value = 0xCBF29CE484222325
    for byte in data:
        value = ((value ^ byte) * 0x100000001B3) & 0xFFFFFFFFFFFFFFFF
    return value


def refusal(kind, address, **options):
    try:
        disparity.SocketClient(address, timeout=60, options=disparity.ConnectOptions(**options)).close()
    except kind as error:
        return str(error)
    raise AssertionError(f"{options} is accepted")


def check_refusals(address, authority, certificate, key, token_file):
    own = {"certificate": certificate, "key": key}
    told = refusal(disparity.DisparityError, address, authority=authority, token_file=token_file)
    assert "certificate required" in told or "ended" in told, told
    told = refusal(disparity.DisparityError, address, authority=authority, **own)
    assert "a token is needed" in told, told
    told = refusal(disparity.Refused, address, authority=authority, token="0123456789abcdeg", **own)
    assert "this token is not known" in told, told
    told = refusal(disparity.DisparityError, address, token_file=token_file, **own)
    assert "self-signed" in told or "issuer" in told, told
    told = refusal(disparity.DisparityError, address, authority=authority, server_name="elsewhere", **own)
    assert "elsewhere" in told, told
    told = refusal(ValueError, address, authority=authority, certificate=certificate)
    assert "go together" in told, told
    told = refusal(ValueError, address, authority=authority, certificate=certificate, key=authority)
    assert authority in told, told
    told = refusal(ValueError, address, authority=key)
    assert key in told, told
    os.chmod(token_file, 0o644)
    told = refusal(ValueError, address, authority=authority, token_file=token_file, **own)
    assert "chmod o-rw" in told, told
    os.chmod(token_file, 0o600)


def check_many(address, options):
    """Forty connections begin at once: all come in, and each gets a frame."""
    served, together = [], threading.Barrier(40)

    def one():
        together.wait()
        with disparity.SocketClient(address, timeout=60, options=options) as client:
            client.subscribe([disparity.DISPARITY])
            served.append(client.read(timeout=60))

    threads = [threading.Thread(target=one) for _ in range(together.parties)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(served) == together.parties and None not in served, f"{len(served)} of {together.parties} came in"


def main():
    address, authority, certificate, key, token_file = sys.argv[1:]
    check_refusals(address, authority, certificate, key, token_file)
    options = disparity.ConnectOptions(
        authority=authority, certificate=certificate, key=key, token_file=token_file)
    with disparity.SocketClient(address, timeout=60, options=options) as client:
        try:
            client.start_recording("a.mkv", timeout=60)
            raise AssertionError("a viewer may record")
        except disparity.Refused as error:
            assert "may look only" in str(error), error
        client.subscribe([disparity.DISPARITY, disparity.LEFT_COLOUR])
        assert client.read_sensors(timeout=0) is None
        for _ in range(3):
            frame = client.read(timeout=60)
            for product, plane in frame.planes.items():
                print(frame.publish_index, product, f"{fnv1a(plane.tobytes()):016x}")
    check_many(address, options)


if __name__ == "__main__":
    main()
