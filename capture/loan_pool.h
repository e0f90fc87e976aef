// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <numeric>
#include <vector>

namespace disparityd::capture {

/// Says which of a fixed number of buffers are free. It knows their numbers, not their memory. It allocates when it is
/// made and never again. Its owner locks it.
class LoanPool {
public:
    /// The buffers 0 to `buffers` - 1, all of them free.
    explicit LoanPool(std::size_t buffers) : free_(buffers) { std::iota(free_.begin(), free_.end(), std::size_t{0}); }

    bool has_free() const { return !free_.empty(); }

    /// Takes the buffer that came back last: its memory is the likeliest to be in a cache. One must be free.
    std::size_t take() noexcept {
        const std::size_t number = free_.back();
        free_.pop_back();
        return number;
    }

    /// Ends a loan. The number must come from take().
    void give_back(std::size_t number) noexcept { free_.push_back(number); }  // within its capacity

private:
    std::vector<std::size_t> free_;
};

}  // namespace disparityd::capture
