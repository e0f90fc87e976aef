// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

namespace disparityd::daemon {

/// Counts how many frames a client may still be sent (Subscribe.by_credit). A client that reads slowly gives credit
/// slowly, so that no frame grows old on its way. One thread (the server's).
class FrameCredit {
public:
    /// More is not kept: a client cannot order a queue of old frames.
    static constexpr std::uint32_t most = 16;

    /// Begins without credit, or without a limit for a client that gives none.
    void start(bool by_credit) {
        limited_ = by_credit;
        left_ = 0;
    }

    void add(std::uint32_t frames) { left_ = std::min(most, left_ + std::min(most, frames)); }

    /// Counts a frame.
    void take() { left_ -= limited_ && left_ > 0 ? 1 : 0; }

    bool allows_one() const { return !limited_ || left_ > 0; }
    bool limited() const { return limited_; }

private:
    bool limited_ = false;
    std::uint32_t left_ = 0;
};

}  // namespace disparityd::daemon
