// SPDX-License-Identifier: Apache-2.0
//
// What a visitor sends when its connection to disparity-web has become a WebSocket: frames, whole or broken. The first
// byte chooses the page's protocol or Foxglove's.
#include "tests/fuzz/outcome.h"
#include "tests/fuzz/web_visitor.h"

using namespace disparityd;

namespace {

std::string upgrade(const char* protocol) {
    return "GET /live HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
           "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: " +
           std::string(protocol) + "\r\n\r\n";
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) {
        return 0;
    }
    fuzz::WebVisitor visitor;
    visitor.say(upgrade((data[0] & 1U) == 0 ? "disparityd.live.v1" : "foxglove.sdk.v1"));
    fuzz::expect(visitor.take_answers().starts_with("HTTP/1.1 101 "), "no WebSocket");
    visitor.say(fuzz::text_of(data + 1, size - 1));
    visitor.publish();
    return 0;
}
