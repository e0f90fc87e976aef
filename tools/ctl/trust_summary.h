// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "clients/json/message_json.h"
#include "proto/doubt.h"
#include "trust/judge.h"

namespace disparityd::tools {

/// How far the frames of a run can be trusted, and in how many of them each doubt was.
class TrustSummary {
public:
    /// Takes one frame. One that was too small to be judged does not count.
    void add(const trust::Verdict& verdict);

    /// Returns the mean trust, 0 .. 1, and the frames with each doubt that there was; null when nothing was judged.
    json::Json as_json() const;

    /// Returns one line for people; empty when nothing was judged.
    std::string text() const;

private:
    double mean() const { return static_cast<double>(sum_) / (255.0 * static_cast<double>(frames_)); }

    std::uint64_t frames_ = 0;
    std::uint64_t sum_ = 0;
    std::array<std::uint64_t, proto::doubts.size()> with_{};  ///< frames with each doubt
};

}  // namespace disparityd::tools
