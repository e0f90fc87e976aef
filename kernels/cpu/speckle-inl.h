// SPDX-License-Identifier: Apache-2.0
// Step 10 of docs/algorithm.md. A run is a part of a row that holds together; runs are joined with those of the row
// above where they touch, so that what has to be followed is a few per cent of the pixels, and the pixels become bits.
#if defined(DISPARITYD_CPU_SPECKLE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_SPECKLE_INL_H_
#undef DISPARITYD_CPU_SPECKLE_INL_H_
#else
#define DISPARITYD_CPU_SPECKLE_INL_H_
#endif

#include <algorithm>
#include <bit>
#include <span>

#include "kernels/cpu/row_bits-inl.h"
#include "kernels/cpu/run_regions.h"
#include "kernels/reference/steps.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// The runs of one row.
class RowRuns {
public:
    void find(const LikenessBits& bits, int width, RunRegions& regions) {
        std::uint64_t valid_before = 0;  // of the last pixel of the word before
        for (int w = 0; 64 * w < width; ++w) {
            const std::uint64_t valid = bits.valid.words[w];
            const std::uint64_t like_left = bits.like_left.words[w];
            like_left_.words[w] = like_left;
            begins_.words[w] = valid & ~like_left;
            first_run_[w] = regions.begun();
            for (std::uint64_t left = begins_.words[w]; left != 0; left &= left - 1) {
                regions.begin(64 * w + std::countr_zero(left));
            }
            for (std::uint64_t left = (valid << 1 | valid_before) & ~like_left; left != 0; left &= left - 1) {
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
                     RunRegions& regions) {
        std::uint64_t before = 0;
        for (int w = 0; 64 * w < width; ++w) {
            const std::uint64_t touching = like_above.words[w];
            const std::uint64_t same_runs = row.like_left_.words[w] & above.like_left_.words[w];
            std::uint64_t left = touching & ~((touching << 1 | before) & same_runs);
            for (; left != 0; left &= left - 1) {
                const int bit = std::countr_zero(left);
                regions.join(above.run_at(w, bit), row.run_at(w, bit));
            }
            before = touching >> 63;
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

inline std::size_t speckle_scratch(int width, int height) {
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    return RunRegions::bytes(pixels) + static_cast<std::size_t>(height + 1) * sizeof(std::int32_t);
}

/// `first_of_row` gets the number of runs above each row, and one more entry for the end.
inline void find_regions(Plane<const std::int16_t> disparity, std::int16_t invalid, int max_step, RunRegions& regions,
                         std::int32_t* first_of_row) {
    const int width = disparity.width;
    const Likeness likeness(invalid, max_step);
    LikenessBits bits;
    PaddedRow pixels[2];
    RowRuns runs[2];
    pixels[1].clear(width, invalid);
    for (int y = 0; y < disparity.height; ++y) {
        const int now = y % 2;
        pixels[now].load(disparity.row(y), width, invalid);
        likeness.row(pixels[now], pixels[1 - now], width, bits);
        first_of_row[y] = regions.begun();
        runs[now].find(bits, width, regions);
        RowRuns::join(runs[1 - now], runs[now], bits.like_above, width, regions);
    }
    first_of_row[disparity.height] = regions.begun();
}

/// Runs of a row that are to be rejected, without a branch for each: where they begin and end a bit is flipped, and all
/// between two flips is set in one go.
class RejectedRuns {
    using Numbers = hn::ScalableTag<std::int16_t>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Numbers()));

public:
    void add_if(bool rejected, int begin, int end) {
        const auto bit = static_cast<std::uint64_t>(rejected);
        flips_[begin / 64] ^= bit << (begin % 64);
        flips_[end / 64] ^= bit << (end % 64);
    }

    /// Writes `invalid` where they are, and forgets them.
    void write(std::int16_t* pixels, int width, std::int16_t invalid) {
        std::uint64_t inside = 0;  // all bits, when a run goes on from the word before
        for (int first = 0; first < width; first += 64) {
            const std::uint64_t rejected = inside ^ odd_flips_up_to(flips_[first / 64]);
            inside = rejected >> 63 != 0 ? ~std::uint64_t{0} : 0;
            flips_[first / 64] = 0;
            if (rejected != 0) {
                write(pixels + first, std::min(width - first, 64), rejected, invalid);
            }
        }
        flips_[width / 64] = 0;
    }

private:
    static std::uint64_t odd_flips_up_to(std::uint64_t flips) {
        for (int shift = 1; shift < 64; shift *= 2) {
            flips ^= flips << shift;
        }
        return flips;
    }

    static void write(std::int16_t* pixels, int count, std::uint64_t rejected, std::int16_t invalid) {
        std::uint8_t bits[8 + 8] = {};  // LoadMaskBits may read eight bytes
        std::memcpy(bits, &rejected, sizeof(rejected));
        int x = 0;
        for (; x + lanes <= count; x += lanes) {
            const auto mask = hn::LoadMaskBits(Numbers(), bits + x / 8);
            const auto found = hn::LoadU(Numbers(), pixels + x);
            hn::StoreU(hn::IfThenElse(mask, hn::Set(Numbers(), invalid), found), Numbers(), pixels + x);
        }
        for (; x < count; ++x) {
            pixels[x] = (rejected >> x & 1) != 0 ? invalid : pixels[x];
        }
    }

    std::uint64_t flips_[RowBits::size + 1] = {};
};

inline void speckle(Plane<std::int16_t> disparity, std::int16_t invalid, int min_size, int max_step,
                    std::span<std::byte> scratch) {
    if (max_step < 0) {
        reference::speckle(disparity, invalid, min_size, max_step, scratch);
        return;
    }
    const std::size_t pixels = static_cast<std::size_t>(disparity.width) * static_cast<std::size_t>(disparity.height);
    RunRegions regions(scratch.data(), pixels);
    auto* first_of_row = reinterpret_cast<std::int32_t*>(scratch.data() + RunRegions::bytes(pixels));
    find_regions(disparity, invalid, max_step, regions, first_of_row);
    RejectedRuns rejected;
    for (int y = 0; y < disparity.height; ++y) {
        for (int run = first_of_row[y]; run < first_of_row[y + 1]; ++run) {
            rejected.add_if(regions.size_of_region(run) < min_size, regions.begin_of(run), regions.end_of(run));
        }
        rejected.write(disparity.row(y), disparity.width, invalid);
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
