// SPDX-License-Identifier: Apache-2.0
// Step 10 of docs/algorithm.md. A run is a part of a row that holds together; runs are joined with those of the row
// above where they touch, so that what has to be followed is a few per cent of the pixels, and the pixels become bits.
// Bands of rows are worked on side by side and joined at their borders.
#if defined(DISPARITYD_CPU_POST_SPECKLE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_POST_SPECKLE_INL_H_
#undef DISPARITYD_CPU_POST_SPECKLE_INL_H_
#else
#define DISPARITYD_CPU_POST_SPECKLE_INL_H_
#endif

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>

#include "kernels/cpu/post/row_bits-inl.h"
#include "kernels/cpu/post/run_regions.h"
#include "kernels/cpu/post/texture_votes-inl.h"
#include "kernels/reference/steps.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// Runs of a row, rejected without a branch for each: where they begin and end a bit is flipped, and all between two
/// flips is set in one go.
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
        std::uint8_t bits[mask_bytes] = {};
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

class SpeckleFilter {
    /// Runs [first, last) of a row.
    struct RunsOfRow {
        std::int32_t first;
        std::int32_t last;
    };

public:
    static std::size_t bytes(int width, int height) {
        const std::size_t rows = static_cast<std::size_t>(height);
        return RunRegions::bytes(rows * static_cast<std::size_t>(width)) + rows * sizeof(RunsOfRow);
    }

    SpeckleFilter(Plane<std::int16_t> disparity, const RegionTest& test, std::span<std::byte> scratch)
        : disparity_(disparity),
          test_(test),
          width_(disparity.width),
          invalid_(test.invalid),
          likeness_(test.invalid, test.max_step),
          memory_(scratch.data()),
          pixels_(static_cast<std::size_t>(disparity.width) * static_cast<std::size_t>(disparity.height)),
          runs_(reinterpret_cast<RunsOfRow*>(memory_ + RunRegions::bytes(pixels_))) {}

    /// Regions within the band.
    void find(Rows band) const {
        // Every run has a pixel: no more of them come before the band than there are pixels above it.
        RunRegions regions(memory_, pixels_, band.first * width_);
        LikenessBits bits;
        PaddedRow pixels[2];
        RowRuns runs[2];
        TextureVotes votes(test_.left, test_.right);
        pixels[(band.first + 1) % 2].clear(width_, invalid_);
        for (int y = band.first; y < band.last; ++y) {
            const int now = y % 2;
            pixels[now].load(disparity_.row(y), width_, invalid_);
            likeness_.row(pixels[now], pixels[1 - now], width_, bits);
            runs_[y].first = regions.begun();
            runs[now].find(bits, width_, regions.begun());
            runs[now].add_to(regions, bits, width_);
            runs_[y].last = regions.begun();
            if (by_texture()) {
                votes.find(y, pixels[now], invalid_);
                for (int run = runs_[y].first; run < runs_[y].last; ++run) {
                    regions.vote(run, votes.between(regions.begin_of(run), regions.end_of(run)));
                }
            }
            if (y > band.first) {
                RowRuns::join(runs[1 - now], runs[now], bits.like_above, width_, regions, by_texture());
            }
        }
        regions.flatten();
    }

    /// Joins the regions above row y with those below, when both bands have been found.
    void join_at(int y) const {
        RunRegions regions(memory_, pixels_);
        LikenessBits bits;
        PaddedRow pixels[3];
        RowRuns runs[2];
        pixels[0].clear(width_, invalid_);
        for (int i = 0; i < 2; ++i) {
            pixels[i + 1].load(disparity_.row(y - 1 + i), width_, invalid_);
            likeness_.row(pixels[i + 1], pixels[i], width_, bits);
            runs[i].find(bits, width_, runs_[y - 1 + i].first);
        }
        RowRuns::join(runs[0], runs[1], bits.like_above, width_, regions, by_texture());
    }

    /// When all is joined.
    void reject(Rows rows) const {
        const RunRegions regions(memory_, pixels_);
        RejectedRuns rejected;
        for (int y = rows.first; y < rows.last; ++y) {
            for (int run = runs_[y].first; run < runs_[y].last; ++run) {
                rejected.add_if(!passes(regions, regions.root_of(run)), regions.begin_of(run), regions.end_of(run));
            }
            rejected.write(disparity_.row(y), width_, invalid_);
        }
    }

private:
    bool by_texture() const { return test_.min_texture > 0; }

    bool passes(const RunRegions& regions, int root) const {
        return regions.pixels(root) >= test_.min_size &&
               (!by_texture() || has_texture(regions.votes(root), regions.pixels(root), test_.min_texture));
    }

    Plane<std::int16_t> disparity_;
    const RegionTest& test_;
    int width_;
    std::int16_t invalid_;
    Likeness likeness_;
    std::byte* memory_;
    std::size_t pixels_;
    RunsOfRow* runs_;
};

inline std::size_t speckle_scratch(int width, int height) {
    return SpeckleFilter::bytes(width, height);
}

inline void speckle(Plane<std::int16_t> disparity, const RegionTest& test, std::span<std::byte> scratch,
                    Parallel& workers) {
    if (test.max_step < 0) {
        reference::speckle(disparity, test, scratch);
        return;
    }
    constexpr int min_rows = 16;  // a border costs as much as a few rows
    const SpeckleFilter filter(disparity, test, scratch);
    const int height = disparity.height;
    // A few for each worker: what a band takes depends on what is in it.
    const int wanted = workers.workers() == 1 ? 1 : 4 * workers.workers();
    const int bands = std::clamp(height / min_rows, 1, wanted);
    const auto begin_of = [=](int band) { return height * band / bands; };
    workers.for_each(bands, [&](int band) { filter.find({begin_of(band), begin_of(band + 1)}); });
    for (int band = 1; band < bands; ++band) {
        filter.join_at(begin_of(band));
    }
    workers.for_each(bands, [&](int band) { filter.reject({begin_of(band), begin_of(band + 1)}); });
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
