// SPDX-License-Identifier: Apache-2.0
// For step 10 of docs/algorithm.md: the runs of a row, and which of them touch those of the row above.
#if defined(DISPARITYD_CPU_POST_ROW_RUNS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_POST_ROW_RUNS_INL_H_
#undef DISPARITYD_CPU_POST_ROW_RUNS_INL_H_
#else
#define DISPARITYD_CPU_POST_ROW_RUNS_INL_H_
#endif

#include <bit>
#include <cstdint>

#include "kernels/cpu/post/row_bits-inl.h"
#include "kernels/cpu/post/run_regions.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

class RowRuns {
public:
    /// Runs are counted from `first_run`.
    void find(const LikenessBits& bits, int width, int first_run) {
        for (int w = 0; 64 * w < width; ++w) {
            like_left_.words[w] = bits.like_left.words[w];
            begins_.words[w] = bits.valid.words[w] & ~like_left_.words[w];
            first_run_[w] = first_run;
            first_run += std::popcount(begins_.words[w]);
        }
    }

    void add_to(RunRegions& regions, const LikenessBits& bits, int width) const {
        std::uint64_t valid_before = 0;  // of the last pixel of the word before
        for (int w = 0; 64 * w < width; ++w) {
            const std::uint64_t valid = bits.valid.words[w];
            for (std::uint64_t left = begins_.words[w]; left != 0; left &= left - 1) {
                regions.begin(64 * w + std::countr_zero(left));
            }
            const std::uint64_t ends = (valid << 1 | valid_before) & ~like_left_.words[w];
            for (std::uint64_t left = ends; left != 0; left &= left - 1) {
                regions.end(64 * w + std::countr_zero(left));
            }
            valid_before = valid >> 63;
        }
        if (width % 64 == 0 && valid_before != 0) {
            regions.end(width);
        }
    }

    /// Joins runs of `row` with those of the row above that they are alike to somewhere: once for each stretch.
    static void join(const RowRuns& above, const RowRuns& row, const RowBits& like_above, int width,
                     RunRegions& regions, bool with_votes) {
        std::uint64_t last_bit = 0;
        for (int w = 0; 64 * w < width; ++w) {
            const std::uint64_t touching = like_above.words[w];
            const std::uint64_t same_runs = row.like_left_.words[w] & above.like_left_.words[w];
            std::uint64_t left = touching & ~((touching << 1 | last_bit) & same_runs);
            for (; left != 0; left &= left - 1) {
                const int bit = std::countr_zero(left);
                regions.join(above.run_at(w, bit), row.run_at(w, bit), with_votes);
            }
            last_bit = touching >> 63;
        }
    }

private:
    int run_at(int word, int bit) const {
        return first_run_[word] + std::popcount(begins_.words[word] << (63 - bit)) - 1;
    }

    RowBits begins_;
    RowBits like_left_;
    int first_run_[RowBits::size];  // the first run that begins in each word
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
