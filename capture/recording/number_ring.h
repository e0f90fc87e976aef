// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace disparityd::capture {

/// A queue of buffer numbers. It allocates when it is made and never again. Its owner locks it.
class NumberRing {
public:
    /// Holds up to `capacity` numbers, which is at least 1.
    explicit NumberRing(std::size_t capacity) : numbers_(capacity) {}

    bool empty() const { return count_ == 0; }

    /// The ring must not be full.
    void push(std::size_t number) noexcept { numbers_[(first_ + count_++) % numbers_.size()] = number; }

    /// The number that was pushed first. The ring must not be empty.
    std::size_t front() const noexcept { return numbers_[first_]; }

    /// Removes and returns front().
    std::size_t pop() noexcept {
        const std::size_t number = front();
        first_ = (first_ + 1) % numbers_.size();
        --count_;
        return number;
    }

private:
    std::vector<std::size_t> numbers_;
    std::size_t first_ = 0;
    std::size_t count_ = 0;
};

}  // namespace disparityd::capture
