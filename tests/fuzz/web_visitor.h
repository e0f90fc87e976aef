// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace disparityd::fuzz {

/// disparity-web with one visitor, without network: a socket pair instead. A daemon is there that serves one frame, but
/// none answers requests.
class WebVisitor {
public:
    WebVisitor();
    ~WebVisitor();
    WebVisitor(const WebVisitor&) = delete;
    WebVisitor& operator=(const WebVisitor&) = delete;

    /// Sends to the server, and lets it do all that it can do now. What the server cannot take any more is thrown away.
    void say(std::string_view bytes);

    /// Lets a frame come from the daemon, and images and answers be made.
    void publish();

    /// Returns what the server has said, without what was taken before; the newest 64 KiB of it.
    std::string take_answers();

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace disparityd::fuzz
