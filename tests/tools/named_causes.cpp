// SPDX-License-Identifier: Apache-2.0
#include "tests/tools/named_causes.h"

#include <string>

#include <gtest/gtest.h>

#include "kernels/pair_matcher.h"
#include "kernels/parallel.h"

namespace disparityd::empty_result {

using test::made_range;
using test::made_size;
using test::RenderedPair;

Plane<const std::uint8_t> view(const cv::Mat& image) {
    return {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step)};
}

namespace {

EmptyResult result_of(const RenderedPair& pair, const MatchOptions& options) {
    const int width = made_size.width, height = made_size.height;
    cv::Mat disparity(made_size, CV_16SC1), confidence(made_size, CV_8UC1);
    PairMatcher matcher(width, height, options, "cpu");
    Serial workers;
    matcher.match(
        view(pair.left), view(pair.right),
        {{disparity.ptr<std::int16_t>(), width, height, width}, {confidence.data, width, height, width}, {}, {}},
        workers);
    EmptyResult result(options.range);
    result.add(view(pair.left), view(pair.right), view(confidence));
    return result;
}

/// Each preset in turn.
MatchOptions preset_of(unsigned seed) {
    constexpr std::array presets{Preset::paper, Preset::dense, Preset::obstacles};
    return preset_options(presets[seed % presets.size()], made_range);
}

/// What is told of that pair. A calibration whose size is far from that of the images is refused before anything is
/// matched, and the refusal names the size.
std::string note_of(const Kind& kind, unsigned seed) {
    try {
        const RenderedPair pair = kind.make(seed);
        return result_of(pair, preset_of(seed)).note(pair.calibration);
    } catch (const std::invalid_argument& refused) {
        const std::string why = refused.what();
        return why.find("compare the size that the calibration was made for") != std::string::npos
                   ? "the calibration is of another resolution"
                   : why;
    }
}

}  // namespace

int rightly_named(const Kind& kind, unsigned first, unsigned count) {
    int right = 0;
    for (unsigned seed = first; seed < first + count; ++seed) {
        right += note_of(kind, seed).find(kind.words) != std::string::npos ? 1 : 0;
    }
    return right;
}

void expect_nothing_told_of_good_pairs(unsigned first, unsigned count) {
    for (unsigned seed = first; seed < first + count; ++seed) {
        const RenderedPair pair = test::good_pair(seed);
        EXPECT_EQ(likely_cause({view(pair.left), view(pair.right), made_range, pair.calibration}).cause, Cause::unknown)
            << "seed " << seed;
        for (const MatchOptions& options :
             {preset_of(0), preset_of(1), preset_of(2), default_options(Method::census, made_range),
              default_options(Method::sad, made_range)}) {
            const std::string note = result_of(pair, options).note(pair.calibration);
            // CENSUS keeps less than a tenth of a picture that is dark and noisy: that is told, and no cause is named.
            const bool few = options.method == Method::census && note.find("cause: not known") != std::string::npos;
            EXPECT_TRUE(note.empty() || few) << "seed " << seed << ", " << to_string(options.method) << ": " << note;
        }
    }
}

}  // namespace disparityd::empty_result
