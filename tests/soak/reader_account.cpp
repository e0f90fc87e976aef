// SPDX-License-Identifier: Apache-2.0
#include "tests/soak/reader_account.h"

#include <algorithm>
#include <stdexcept>

#include <nlohmann/json.hpp>
#include <poll.h>
#include <unistd.h>

namespace disparityd::test {
namespace {

std::string numbers(const SeenFrame& frame) {
    return "frame " + std::to_string(frame.publish_index) + " (sequence " + std::to_string(frame.sequence) + ", " +
           std::to_string(frame.skipped) + " skipped, " + std::to_string(frame.dropped_before) + " dropped before)";
}

}  // namespace

void ReaderAccount::add(const SeenFrame& frame) {
    if (frames_ == 0) {
        first_ = frame.publish_index;
    } else {
        // The daemon lives through the whole test, so its count of published frames never begins anew.
        if (frame.publish_index != last_.publish_index + 1 + frame.skipped) {
            throw std::logic_error(numbers(frame) + " came after " + numbers(last_));
        }
        const bool source_counts_on = frame.skipped == 0 && !frame.discontinuity;
        if (source_counts_on && frame.sequence != last_.sequence + 1 + frame.dropped_before) {
            throw std::logic_error(numbers(frame) + " hides a loss after " + numbers(last_));
        }
        skipped_ += frame.skipped;
    }
    ++frames_;
    last_ = frame;
    ages_ms_.push_back(static_cast<float>(static_cast<double>(frame.age_ns) / 1e6));
}

std::string ReaderAccount::to_json() const {
    std::vector<float> ages = ages_ms_;
    std::sort(ages.begin(), ages.end());
    const auto percentile = [&](std::size_t percent) {
        return ages.empty() ? 0 : ages[(ages.size() - 1) * percent / 100];
    };
    const nlohmann::json account{{"frames", frames_},
                                 {"skipped", skipped_},
                                 {"first", first_},
                                 {"last", last_.publish_index},
                                 {"age_ms", {percentile(50), percentile(99), percentile(100)}},
                                 {"refusals", refusals_}};
    return account.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

bool asked_to_end() {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    return poll(&input, 1, 0) > 0;
}

}  // namespace disparityd::test
