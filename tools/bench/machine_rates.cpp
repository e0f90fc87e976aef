// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/machine_rates.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <numeric>
#include <vector>

#include "kernels/cpu/cache_size.h"
#include "kernels/large_buffer.h"
#include "tools/bench/vector_peak.h"
#include "tools/eval/median.h"

namespace disparityd::bench {
namespace {

using std::chrono::steady_clock;

/// Pieces short enough that most of them are not interrupted.
constexpr std::size_t max_piece = std::size_t{4} << 20;
constexpr std::size_t line_bytes = 64;

/// What all workers together do per second: the sum of the workers' median rates over their pieces of work.
/// `work(worker, piece)` does a piece and returns how much it was.
double rate(Parallel& workers, int pieces, FunctionRef<double(int, int)> work) {
    std::vector<double> rates(static_cast<std::size_t>(workers.workers()));
    workers.for_each(workers.workers(), [&](int worker) {
        std::vector<double> of_pieces;
        for (int piece = 0; piece < pieces; ++piece) {
            const auto start = steady_clock::now();
            const double done = work(worker, piece);
            const std::chrono::duration<double> taken = steady_clock::now() - start;
            of_pieces.push_back(done / taken.count());
        }
        rates[static_cast<std::size_t>(worker)] = eval::median(of_pieces);
    });
    return std::accumulate(rates.begin(), rates.end(), 0.0);
}

/// Memory divided among workers, each part divided into pieces of whole cache lines, all of it touched.
class Pieces {
public:
    Pieces(std::size_t bytes, int workers)
        : piece_bytes_(
              std::clamp(bytes / static_cast<std::size_t>(workers) / line_bytes * line_bytes, line_bytes, max_piece)),
          pieces_(std::max(1, static_cast<int>(bytes / piece_bytes_ / static_cast<std::size_t>(workers)))),
          buffer_(piece_bytes_ * static_cast<std::size_t>(pieces_) * static_cast<std::size_t>(workers)) {
        std::memset(buffer_.data(), 1, buffer_.size());
    }

    int pieces() const { return pieces_; }
    std::size_t piece_bytes() const { return piece_bytes_; }
    std::byte* piece(int worker, int i) const {
        return buffer_.data() + piece_bytes_ * static_cast<std::size_t>(worker * pieces_ + i % pieces_);
    }

private:
    std::size_t piece_bytes_;
    int pieces_;
    LargeBuffer buffer_;
};

double read_rate(std::size_t bytes, Parallel& workers) {
    const Pieces memory(bytes, workers.workers());
    std::vector<std::uint64_t> sums(static_cast<std::size_t>(workers.workers()));
    return rate(workers, memory.pieces(), [&](int worker, int i) {
        const auto* words = reinterpret_cast<const std::uint64_t*>(memory.piece(worker, i));
        std::uint64_t sum[8] = {};
        for (std::size_t k = 0; k < memory.piece_bytes() / sizeof(std::uint64_t); k += 8) {
            for (std::size_t j = 0; j < 8; ++j) {
                sum[j] += words[k + j];
            }
        }
        sums[static_cast<std::size_t>(worker)] += std::accumulate(sum, sum + 8, std::uint64_t{0});
        return static_cast<double>(memory.piece_bytes());
    });
}

/// `rounds`: how often the same bytes are copied.
double copy_rate(std::size_t bytes, int rounds, Parallel& workers) {
    const Pieces from(bytes, workers.workers());
    const Pieces to(bytes, workers.workers());
    return rate(workers, from.pieces() * rounds, [&](int worker, int i) {
        std::memcpy(to.piece(worker, i), from.piece(worker, i), from.piece_bytes());
        return static_cast<double>(from.piece_bytes());
    });
}

}  // namespace

MachineRates measure_machine(std::int64_t target, Parallel& workers) {
    const std::size_t cache = cpu::last_level_cache_bytes();
    const std::size_t beyond_cache = std::clamp(4 * cache, std::size_t{64} << 20, std::size_t{512} << 20);
    constexpr int cached_rounds = 16, operation_pieces = 40;
    return {read_rate(beyond_cache, workers), copy_rate(beyond_cache, 1, workers),
            copy_rate(cache / 4, cached_rounds, workers),
            rate(workers, operation_pieces, [&](int, int) { return do_byte_operations(target); })};
}

}  // namespace disparityd::bench
