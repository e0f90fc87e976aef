// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <optional>
#include <utility>

#include "kernels/raw_image.h"

namespace disparityd::capture {

/// Finds which images of two eyes belong together: those of the same stamp, else those nearest to each other, at most
/// `within_ns` apart. An image that comes behind a later one of its eye may find its partner gone. `Image` has stamp_ns
/// and bytes(). One thread uses an object.
template <class Image>
class StampPairs {
public:
    struct Pair {
        Image left;
        Image right;
    };

    /// `interval_ns` is the time from one image of an eye to the next, 0: unknown. Where it is known, an image is not
    /// waited for that cannot be nearer.
    explicit StampPairs(std::int64_t within_ns, std::int64_t interval_ns = 0)
        : within_ns_(within_ns), interval_ns_(interval_ns) {}

    void set_interval(std::int64_t interval_ns) { interval_ns_ = interval_ns; }

    void add(Eye eye, Image image) {
        Waiting& list = of(eye);
        bytes_ += image.bytes();
        const auto later =
            std::upper_bound(list.begin(), list.end(), image.stamp_ns,
                             [](std::int64_t stamp, const Image& other) { return stamp < other.stamp_ns; });
        list.insert(later, std::move(image));
    }

    /// Returns the next pair as soon as no later image can be a nearer partner, or too many wait for one; `ended`:
    /// there are no later ones.
    std::optional<Pair> take(bool ended) {
        for (;;) {
            Waiting& left = of(Eye::left);
            Waiting& right = of(Eye::right);
            if (left.empty() || right.empty()) {
                drop_surplus(left.empty() ? Eye::right : Eye::left, ended);
                return std::nullopt;
            }
            const Eye earlier = left.front().stamp_ns <= right.front().stamp_ns ? Eye::left : Eye::right;
            const std::int64_t apart = std::abs(left.front().stamp_ns - right.front().stamp_ns);
            if (apart > within_ns_) {
                drop(earlier);
                continue;
            }
            const Waiting& others = of(earlier == Eye::left ? Eye::right : Eye::left);
            const bool room = others.size() <= most_waiting && bytes_ <= most_bytes;
            const bool nearest = 4 * apart <= interval_ns_;  // half of it would do, were images always in time
            if (apart > 0 && !nearest && of(earlier).size() < 2 && !ended && room) {
                return std::nullopt;  // the one that follows may be nearer
            }
            const std::int64_t other = others.front().stamp_ns;
            if (apart > 0 && of(earlier).size() > 1 && std::abs(of(earlier)[1].stamp_ns - other) < apart) {
                drop(earlier);
                continue;
            }
            return Pair{take_first(Eye::left), take_first(Eye::right)};
        }
    }

    /// Returns how many images of the eye that lost more found no partner since the last call.
    std::uint32_t take_unpaired() {
        const std::uint32_t lost = std::max(unpaired_[0], unpaired_[1]);
        unpaired_ = {};
        return lost;
    }

    /// Returns how many images of an eye wait for a partner.
    std::size_t waiting(Eye eye) const { return waiting_[static_cast<std::size_t>(eye)].size(); }

private:
    using Waiting = std::deque<Image>;

    // An eye that is this far ahead has lost its partners: they do not come.
    static constexpr std::size_t most_waiting = 64;
    static constexpr std::size_t most_bytes = std::size_t{512} << 20U;

    Waiting& of(Eye eye) { return waiting_[static_cast<std::size_t>(eye)]; }

    Image take_first(Eye eye) {
        Image image = std::move(of(eye).front());
        of(eye).pop_front();
        bytes_ -= image.bytes();
        return image;
    }

    void drop(Eye eye) {
        take_first(eye);
        ++unpaired_[static_cast<std::size_t>(eye)];
    }

    void drop_surplus(Eye eye, bool ended) {
        while (!of(eye).empty() && (ended || of(eye).size() > most_waiting || bytes_ > most_bytes)) {
            drop(eye);
        }
    }

    const std::int64_t within_ns_;
    std::int64_t interval_ns_;
    std::array<Waiting, 2> waiting_;
    std::array<std::uint32_t, 2> unpaired_{};
    std::size_t bytes_ = 0;
};

}  // namespace disparityd::capture
