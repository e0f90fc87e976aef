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
/// lose the value which was not used for the longest time. For the median of 49 values and 11 registers 250 loads and
/// stores are left of 794, and 90 of 394 with 26, counted as if the value that is needed last always made room.
///
/// Plain arrays, because compilers count each call that they make at this time.
template <std::size_t places, std::size_t size>
class ExchangeOrder {
public:
    constexpr ExchangeOrder(const std::array<Exchange, size>& network, std::size_t registers) : registers_(registers) {
        for (std::size_t& next : next_) {
            next = none;
        }
        for (std::size_t i = size; i-- > 0;) {
            const Exchange& exchange = exchanges_[i] = network[i];
            after_low_[i] = next_[exchange.low];
            after_high_[i] = next_[exchange.high];
            next_[exchange.low] = next_[exchange.high] = i;
        }
    }

    constexpr std::array<ExchangeStep, size> steps() {
        std::array<ExchangeStep, size> result{};
        for (std::size_t now = 0; now < size; ++now) {
            const std::size_t chosen = best();
            const Exchange& exchange = exchanges_[chosen];
            result[now] = {exchange, used_[exchange.low] == 0, used_[exchange.high] == 0};
            take(exchange.low, now + 1, after_low_[chosen]);
            take(exchange.high, now + 1, after_high_[chosen]);
            while (count_ > registers_) {
                lose_the_oldest();
            }
        }
        return result;
    }

private:
    static constexpr std::size_t none = size;

    /// More values that lie in registers come first, then more values that are not needed any more, then those used
    /// last.
    constexpr std::size_t rank(std::size_t i, const Exchange& exchange) const {
        if (registers_ >= places) {
            return 0;  // the order of the network: its neighbours do not wait for each other
        }
        const std::size_t held = (held_[exchange.low] ? 1 : 0) + (held_[exchange.high] ? 1 : 0);
        const std::size_t ends = (after_low_[i] == none ? 1 : 0) + (after_high_[i] == none ? 1 : 0);
        return (held * 3 + ends) * (2 * size + 1) + used_[exchange.low] + used_[exchange.high];
    }

    /// The first one of the highest rank, of those that come next at both of their places.
    constexpr std::size_t best() const {
        std::size_t found = none;
        std::size_t highest = 0;
        for (std::size_t place = 0; place < places; ++place) {
            const std::size_t i = next_[place];
            if (i == none || exchanges_[i].low != place || next_[exchanges_[i].high] != i) {
                continue;
            }
            const std::size_t ranked = rank(i, exchanges_[i]);
            if (found == none || ranked > highest || (ranked == highest && i < found)) {
                found = i;
                highest = ranked;
            }
        }
        return found;
    }

    constexpr void take(std::size_t place, std::size_t now, std::size_t next) {
        used_[place] = now;
        next_[place] = next;
        count_ -= held_[place] ? 1 : 0;
        held_[place] = next != none;
        count_ += held_[place] ? 1 : 0;
    }

    constexpr void lose_the_oldest() {
        std::size_t oldest = places;
        for (std::size_t place = 0; place < places; ++place) {
            if (held_[place] && (oldest == places || used_[place] < used_[oldest])) {
                oldest = place;
            }
        }
        held_[oldest] = false;
        --count_;
    }

    std::size_t registers_;
    Exchange exchanges_[size] = {};
    std::size_t after_low_[size] = {};  ///< the exchange that has the same place next, or none
    std::size_t after_high_[size] = {};
    std::size_t next_[places] = {};  ///< of a place, the first exchange that was not taken
    std::size_t used_[places] = {};  ///< when, counted from 1
    bool held_[places] = {};
    std::size_t count_ = 0;
};

/// The exchanges after which the median of `count` values lies in the middle, in an order for so many registers.
template <std::size_t count, std::size_t registers>
inline constexpr auto median_steps =
    ExchangeOrder<count, exchanges_for_median<count>.size()>(exchanges_for_median<count>, registers).steps();

}  // namespace disparityd::cpu
