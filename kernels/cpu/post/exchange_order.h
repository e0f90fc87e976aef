// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "kernels/selection_network.h"

namespace disparityd::cpu {

/// An exchange, and which of its places hold no value before it.
struct ExchangeStep {
    Exchange exchange;
    bool low_is_new = false;
    bool high_is_new = false;
};

/// Finds an order of the exchanges of a network over `places` values, of which each place sees its own in the order
/// that they had: the result is the same.
///
/// A network goes stage by stage over all places. With more places than registers every stage then loads and stores
/// all of them. Here the next exchange is one whose values were used last: it is greedy, and simulates registers that
/// lose the value which was not used for the longest time. For the median of 49 values and 12 registers 232 loads and
/// stores are left of 762, and 78 of 350 with 28.
template <std::size_t places, std::size_t size>
class ExchangeOrder {
public:
    constexpr ExchangeOrder(const std::array<Exchange, size>& network, std::size_t registers)
        : network_(network), registers_(registers) {
        std::array<std::size_t, places> last{};
        last.fill(none);
        for (std::size_t i = 0; i < size; ++i) {
            before_low_[i] = last[network[i].low];
            before_high_[i] = last[network[i].high];
            last[network[i].low] = last[network[i].high] = i;
        }
        last_ = last;
    }

    constexpr std::array<ExchangeStep, size> steps() {
        std::array<ExchangeStep, size> result{};
        for (std::size_t now = 0; now < size; ++now) {
            const std::size_t next = best();
            const Exchange exchange = network_[next];
            result[now] = {exchange, used_[exchange.low] == 0, used_[exchange.high] == 0};
            done_[next] = true;
            take(exchange.low, now + 1, last_[exchange.low] == next);
            take(exchange.high, now + 1, last_[exchange.high] == next);
            lose_the_oldest();
        }
        return result;
    }

private:
    static constexpr std::size_t none = size;

    constexpr bool ready(std::size_t i) const {
        return !done_[i] && (before_low_[i] == none || done_[before_low_[i]]) &&
               (before_high_[i] == none || done_[before_high_[i]]);
    }

    /// More values that lie in registers come first, then more values that are not needed any more, then those used
    /// last.
    constexpr std::size_t rank(std::size_t i) const {
        if (registers_ >= places) {
            return 0;  // the order of the network: its neighbours do not wait for each other
        }
        const auto [low, high] = network_[i];
        const std::size_t held = (held_[low] ? 1 : 0) + (held_[high] ? 1 : 0);
        const std::size_t ends = (last_[low] == i ? 1 : 0) + (last_[high] == i ? 1 : 0);
        return (held * 3 + ends) * (2 * size + 1) + used_[low] + used_[high];
    }

    constexpr std::size_t best() const {
        std::size_t found = none;
        std::size_t rank_of_found = 0;
        for (std::size_t i = 0; i < size; ++i) {
            if (ready(i) && (found == none || rank(i) > rank_of_found)) {
                found = i;
                rank_of_found = rank(i);
            }
        }
        return found;
    }

    constexpr void take(std::size_t place, std::size_t now, bool for_the_last_time) {
        used_[place] = now;
        count_ -= held_[place] ? 1 : 0;
        held_[place] = !for_the_last_time;
        count_ += held_[place] ? 1 : 0;
    }

    constexpr void lose_the_oldest() {
        while (count_ > registers_) {
            std::size_t oldest = none;
            for (std::size_t place = 0; place < places; ++place) {
                if (held_[place] && (oldest == none || used_[place] < used_[oldest])) {
                    oldest = place;
                }
            }
            held_[oldest] = false;
            --count_;
        }
    }

    const std::array<Exchange, size>& network_;
    std::size_t registers_;
    std::array<std::size_t, size> before_low_{};  ///< the exchange that has the same place before, or none
    std::array<std::size_t, size> before_high_{};
    std::array<std::size_t, places> last_{};  ///< the last exchange of a place
    std::array<bool, size> done_{};
    std::array<std::size_t, places> used_{};  ///< when, counted from 1
    std::array<bool, places> held_{};
    std::size_t count_ = 0;
};

/// The exchanges after which the median of `count` values lies in the middle, in an order for so many registers.
template <std::size_t count, std::size_t registers>
inline constexpr auto median_steps =
    ExchangeOrder<count, exchanges_for_median<count>.size()>(exchanges_for_median<count>, registers).steps();

}  // namespace disparityd::cpu
