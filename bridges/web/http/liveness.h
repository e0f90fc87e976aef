// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace disparityd::web {

/// Decides how long a WebSocket keeps its place: its peer must be heard now and then, if only by its answer to a ping,
/// and must ask for something soon after it has come.
class Liveness {
public:
    using Time = std::chrono::steady_clock::time_point;

    /// A ping waits behind the frame that is on its way out: over a slow link that may take long.
    static constexpr std::chrono::seconds most_silence{60};
    static constexpr std::chrono::seconds silence_to_ask{20};
    static constexpr std::chrono::seconds time_to_subscribe{30};
    /// From one look to the next.
    static constexpr std::chrono::seconds pause{5};

    enum class Verdict { well, ask, end };

    explicit Liveness(Time now) : begun_(now), heard_(now) {}

    /// Something came from the peer.
    void heard(Time now) { heard_ = now; }
    /// The peer has asked for what comes by itself.
    void asked() { has_asked_ = true; }

    Verdict look(Time now) const {
        if (now - heard_ >= most_silence || (!has_asked_ && now - begun_ >= time_to_subscribe)) {
            return Verdict::end;
        }
        return now - heard_ >= silence_to_ask ? Verdict::ask : Verdict::well;
    }

private:
    Time begun_;
    Time heard_;
    bool has_asked_ = false;
};

}  // namespace disparityd::web
