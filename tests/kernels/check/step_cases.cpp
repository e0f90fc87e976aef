// SPDX-License-Identifier: Apache-2.0
// Every function of FrameSteps but rectification: what an instruction set's table has against the reference's.
#include <cmath>

#include "kernels/cpu/step_kernels.h"
#include "kernels/near_plane.h"
#include "kernels/parallel.h"
#include "kernels/scan_counts.h"
#include "obstacles/band.h"
#include "obstacles/scan_geometry.h"
#include "tests/kernels/check/kernel_case.h"
#include "tests/kernels/post/post_inputs.h"

namespace disparityd::test {
namespace {

/// What a step works on: contents drawn from the input's seed, planes that it writes.
struct StepData {
    explicit StepData(const KernelInput& from) : input(from), random(from.seed) {}

    const MatchOptions& options() const { return input.options; }
    DisparityRange range() const { return input.options.range; }
    std::int16_t invalid() const { return invalid_disparity(range()); }

    Size size() const { return {input.width, input.height}; }

    /// Disparities as winner-takes-all and checks leave them: patches with some noise and holes.
    Image<std::int16_t> disparities() {
        if (input.hostile) {
            return test::disparities(random, size(), range());
        }
        Image<std::int16_t> image(input.width, input.height);
        int patch = 16 * range().first;
        for (std::int16_t& value : image.pixels()) {
            if (pick(random, 0, 14) == 0) {
                patch = 16 * (range().first + pick(random, 0, range().count - 1));
            }
            value = static_cast<std::int16_t>(patch + pick(random, -4, 4));
            value = pick(random, 0, 99) < 10 ? invalid() : value;
        }
        return image;
    }
    /// Winners in whole pixels; of the right image, and of hostile left ones, some pixels have none.
    Image<std::int16_t> winners(bool right) {
        Image<std::int16_t> image(input.width, input.height);
        if (input.hostile) {
            image = test::winners(random, size(), range());
        } else {
            for (std::int16_t& value : image.pixels()) {
                value = static_cast<std::int16_t>(range().first + pick(random, -1, range().count - 1));
            }
        }
        const int last = range().first + range().count - 1;
        if (!right && (!input.hostile || pick(random, 0, 1) == 0)) {
            for (std::int16_t& value : image.pixels()) {
                value = static_cast<std::int16_t>(std::clamp<int>(value, range().first, last));
            }
        }
        return image;
    }

    /// An image with regions whose intensities differ by less, exactly and more than what counts as alike.
    Image<std::uint8_t> guide() {
        const int spread = input.hostile ? pick(random, 0, 255) : 60;
        Image<std::uint8_t> image = noise(random, input.width, input.height, 0, spread);
        for (std::uint8_t& value : image.pixels()) {
            value = pick(random, 0, 3) > 0
                        ? static_cast<std::uint8_t>(value / guided_median_tolerance * guided_median_tolerance)
                        : value;
        }
        return image;
    }

    /// Disparities of which any share is rejected.
    Image<std::int16_t> with_holes() {
        Image<std::int16_t> image = disparities();
        const int percent = input.hostile ? pick(random, 0, 100) : 0;
        for (std::int16_t& value : image.pixels()) {
            value = pick(random, 1, 100) <= percent ? invalid() : value;
        }
        return image;
    }

    /// Who computes bands of a frame: one, or, hostile, several in a shuffled order.
    Parallel& workers() {
        if (input.hostile && !several) {
            several = std::make_unique<ShuffledWorkers>(pick(random, 1, 3), input.seed);
        }
        return several ? static_cast<Parallel&>(*several) : serial;
    }

    KernelInput input;
    Random random;
    RunBuffers buffers;
    Serial serial;
    std::unique_ptr<ShuffledWorkers> several;
};

using Data = std::shared_ptr<StepData>;
/// A step bound to its data, and what has to be put back before it runs again.
struct Bound {
    std::function<void(const FrameSteps&)> run;
    std::function<void()> prepare;
};

/// `bind(data, steps)` draws the contents.
KernelCase step_case(const std::string& name, std::function<Bound(const Data&, const FrameSteps&)> bind) {
    const auto bind_variant = [bind](const KernelInput& input, std::int64_t target) {
        const FrameSteps& steps = target == 0 ? reference::steps.frame : cpu::frame_steps(target);
        const auto data = std::make_shared<StepData>(input);
        const Bound bound = bind(data, steps);
        return KernelRun{[bound, &steps, data] { bound.run(steps); }, bound.prepare,
                         [data] { return data->buffers.results(); }, [data] { return data->buffers.intact(); }};
    };
    return {"steps/" + name, bind_variant};
}

template <typename T>
std::function<void()> put_back(const Image<T>& start, Plane<T> to) {
    const auto kept = std::make_shared<Image<T>>(start);
    return [kept, to] {
        for (int y = 0; y < to.height; ++y) {
            std::copy_n(std::as_const(*kept).plane().row(y), to.width, to.row(y));
        }
    };
}

Bound bind_left_right(const Data& data, const FrameSteps&) {
    const auto left = std::make_shared<Image<std::int16_t>>(data->winners(false));
    const auto right = std::make_shared<Image<std::int16_t>>(data->winners(true));
    const auto disparity = data->buffers.result<std::int16_t>(data->input.width, data->input.height);
    return {[=](const FrameSteps& steps) {
                over_parts(data->input, [&](Rows rows) {
                    steps.left_right(left->plane(), right->plane(), data->range(), disparity, rows);
                });
            },
            put_back(data->disparities(), disparity)};
}

template <int size>
Bound bind_median(const Data& data, const FrameSteps&) {
    const auto in = std::make_shared<Image<std::int16_t>>(data->disparities());
    const auto out = data->buffers.result<std::int16_t>(data->input.width, data->input.height);
    return {[=](const FrameSteps& steps) {
                over_parts(data->input,
                           [&](Rows rows) { steps.median(in->plane(), data->invalid(), size, out, rows); });
            },
            {}};
}

Bound bind_smooth(const Data& data, const FrameSteps&) {
    const auto image =
        std::make_shared<Image<std::uint8_t>>(noise(data->random, data->input.width, data->input.height));
    const auto out = data->buffers.result<std::uint8_t>(data->input.width, data->input.height);
    return {[=](const FrameSteps& steps) {
                over_parts(data->input, [&](Rows rows) { steps.smooth(image->plane(), out, rows); });
            },
            {}};
}

/// Within the limits of what matching finds.
Bound bind_vote(const Data& data, const FrameSteps&) {
    const auto in = std::make_shared<Image<std::int16_t>>(data->disparities());
    constexpr int limit = (1 << 14) - 1;
    for (std::int16_t& value : in->pixels()) {
        value = static_cast<std::int16_t>(std::clamp<int>(value, -limit, limit));
    }
    const auto out = data->buffers.result<std::int16_t>(data->input.width, data->input.height);
    return {[=](const FrameSteps& steps) {
                over_parts(data->input, [&](Rows rows) { steps.vote(in->plane(), data->invalid(), out, rows); });
            },
            {}};
}

template <int size>
Bound bind_guided_median(const Data& data, const FrameSteps&) {
    const auto in = std::make_shared<Image<std::int16_t>>(data->disparities());
    const auto guide = std::make_shared<Image<std::uint8_t>>(data->guide());
    const auto out = data->buffers.result<std::int16_t>(data->input.width, data->input.height);
    return {[=](const FrameSteps& steps) {
                over_parts(data->input, [&](Rows rows) {
                    steps.guided_median(in->plane(), guide->plane(), data->invalid(), size, out, rows);
                });
            },
            {}};
}

template <bool with_texture>
Bound bind_speckle(const Data& data, const FrameSteps& steps_to_run) {
    const auto disparity = data->buffers.result<std::int16_t>(data->input.width, data->input.height);
    const auto scratch =
        data->buffers.memory<std::byte>(steps_to_run.speckle_scratch(data->input.width, data->input.height));
    const bool hostile = data->input.hostile;
    const int least = hostile ? pick(data->random, 1, pick(data->random, 0, 1) == 0 ? 8 : 400) : 100;
    const int step = !hostile ? 16 : pick(data->random, 0, 9) == 0 ? 70000 : pick(data->random, 0, 60);
    const int texture = !with_texture ? 0 : hostile ? pick(data->random, 1, 30) : 2;
    const auto pair = std::make_shared<TexturedPair>(data->random, data->size());
    if (!hostile) {
        pair->left = data->guide();
        pair->right = data->guide();
    }
    return {[=](const FrameSteps& steps) {
                steps.speckle(disparity,
                              {data->invalid(), least, step, texture, pair->left.plane(), pair->right.plane()}, scratch,
                              data->workers());
            },
            put_back(data->disparities(), disparity)};
}

template <bool calibrated>
Bound bind_finish_confidence(const Data& data, const FrameSteps&) {
    const auto disparity = std::make_shared<Image<std::int16_t>>(data->disparities());
    const auto confidence = data->buffers.result<std::uint8_t>(data->input.width, data->input.height);
    return {[=](const FrameSteps& steps) {
                over_parts(data->input, [&](Rows rows) {
                    steps.finish_confidence(disparity->plane(), data->invalid(), calibrated, confidence, rows);
                });
            },
            put_back(noise(data->random, data->input.width, data->input.height), confidence)};
}

Bound bind_interpolate(const Data& data, const FrameSteps& steps_to_run) {
    const auto right = std::make_shared<Image<std::int16_t>>(data->winners(true));
    const auto disparity = data->buffers.result<std::int16_t>(data->input.width, data->input.height);
    const auto scratch =
        data->buffers.memory<std::byte>(steps_to_run.interpolate_scratch(data->input.width, data->input.height));
    return {[=](const FrameSteps& steps) {
                steps.interpolate(disparity, right->plane(), data->range(), scratch, data->workers());
            },
            put_back(data->with_holes(), disparity)};
}

Bound bind_depth(const Data& data, const FrameSteps&) {
    const auto disparity = std::make_shared<Image<std::int16_t>>(data->disparities());
    const auto depth = data->buffers.result<std::uint16_t>(data->input.width, data->input.height);
    DepthScale scale{672000, 3};
    if (data->input.hostile) {
        scale = any_scale(data->random);
    }
    return {[=](const FrameSteps& steps) {
                over_parts(data->input,
                           [&](Rows rows) { steps.depth(disparity->plane(), data->invalid(), scale, depth, rows); });
            },
            {}};
}

/// Any mounting, sectors and limits; of a bench those of a robot.
ScanOptions scan_options(StepData& data) {
    ScanOptions options;
    if (!data.input.hostile) {
        options.min_confidence = 100;
        return options;
    }
    const auto any = [&data](int least, int most) { return static_cast<double>(pick(data.random, least, most)); };
    options.sectors = pick(data.random, 1, 360);
    if (pick(data.random, 0, 1) == 0) {
        options.from_deg = any(-180, 100);
        options.to_deg = options.from_deg + any(1, 80);
    }
    options.pitch_deg = any(-45, 45);
    options.roll_deg = any(-45, 45);
    options.yaw_deg = any(-180, 180);
    options.low_m = any(-100, 100) / 100;
    options.high_m = options.low_m + any(1, 300) / 100;
    options.camera_height_m = options.low_m + any(2, 400) / 100;
    options.min_m = any(1, 100) / 100;
    options.max_m = options.min_m + any(1, 60);
    options.min_confidence = pick(data.random, 1, 255);
    options.subpixel_error_px = any(1, 100) / 100;
    return options;
}

Bound bind_scan_counts(const Data& data, const FrameSteps&) {
    const int width = data->input.width;
    const int height = data->input.height;
    const auto disparity = std::make_shared<Image<std::int16_t>>(data->disparities());
    const auto confidence = std::make_shared<Image<std::uint8_t>>(noise(data->random, width, height));
    const ScanOptions options = scan_options(*data);
    const auto geometry = std::make_shared<scan::Geometry>(width, height, options);
    scan::Camera camera{width,       height,       width * 0.55,
                        width / 2.0, height / 2.0, {std::lround(width * 0.55 * 16 * 120), 3}};
    if (data->input.hostile) {
        camera.scale = {pick(data->random, 1, 100000000), pick(data->random, -40000, 40000)};
    }
    geometry->set(camera);
    const auto band = std::make_shared<scan::Band>(width, height);
    band->set(*geometry, {pick(data->random, -10, 10) / 100.0, pick(data->random, -20, 20) / 100.0, 0.05});
    const auto counts = std::make_shared<scan::Counts>(options.sectors, geometry->groups(), width);
    const auto obstacles =
        data->buffers.memory<std::uint32_t>(static_cast<std::size_t>(options.sectors) * scan::used_bins, true);
    const auto seen = data->buffers.memory<std::uint32_t>(counts->seen.size(), true);
    const auto middle_bins = data->buffers.memory<std::uint8_t>(counts->middle_bins.size(), true);
    const auto middle_counted = data->buffers.memory<std::uint8_t>(counts->middle_counted.size(), true);
    return {[=](const FrameSteps& steps) {
                const scan::CountTables tables = scan::count_tables(*geometry, *band);
                steps.scan_counts({disparity->plane(), confidence->plane()}, tables, *counts);
                for (int s = 0; s < counts->sectors; ++s) {
                    std::copy_n(counts->obstacle_of(s), scan::used_bins,
                                &obstacles[static_cast<std::size_t>(s) * scan::used_bins]);
                }
                std::copy(counts->seen.begin(), counts->seen.end(), seen.begin());
                std::copy(counts->middle_bins.begin(), counts->middle_bins.end(), middle_bins.begin());
                std::copy(counts->middle_counted.begin(), counts->middle_counted.end(), middle_counted.begin());
            },
            {}};
}

Bound bind_shrink(const Data& data, const FrameSteps&) {
    const auto image =
        std::make_shared<Image<std::uint8_t>>(noise(data->random, data->input.width, data->input.height));
    const auto out =
        data->buffers.result<std::uint8_t>(near_blocks(data->input.width), near_blocks(data->input.height));
    return {[=](const FrameSteps& steps) {
                const int split = data->input.hostile ? out.height / 2 : out.height;
                steps.shrink(image->plane(), out, {0, split});
                steps.shrink(image->plane(), out, {split, out.height});
            },
            {}};
}

Bound bind_depth_error(const Data& data, const FrameSteps&) {
    const auto disparity = std::make_shared<Image<std::int16_t>>(data->disparities());
    const auto confidence = std::make_shared<Image<std::uint8_t>>(
        noise(data->random, data->input.width, data->input.height, 0, pick(data->random, 0, 1) == 0 ? 1 : 255));
    const auto error = data->buffers.result<std::uint16_t>(data->input.width, data->input.height);
    DepthErrorScale scale = depth_error_scale(672000, 3, 64);
    if (data->input.hostile) {
        scale = any_error_scale(data->random);
    }
    return {[=](const FrameSteps& steps) {
                over_parts(data->input, [&](Rows rows) {
                    steps.depth_error(disparity->plane(), confidence->plane(), scale, error, rows);
                });
            },
            {}};
}

}  // namespace

std::vector<KernelCase> step_cases() {
    std::vector<KernelCase> cases = {
        step_case("left_right", bind_left_right),
        step_case("median3", bind_median<3>),
        step_case("median5", bind_median<5>),
        step_case("smooth", bind_smooth),
        step_case("vote", bind_vote),
        step_case("guided_median5", bind_guided_median<5>),
        step_case("guided_median7", bind_guided_median<7>),
        step_case("speckle", bind_speckle<false>),
        step_case("speckle_texture", bind_speckle<true>),
        step_case("finish_confidence", bind_finish_confidence<false>),
        step_case("calibrated_confidence", bind_finish_confidence<true>),
        step_case("depth", bind_depth),
        step_case("scan_counts", bind_scan_counts),
        step_case("shrink", bind_shrink),
        step_case("depth_error", bind_depth_error),
    };
    for (KernelCase& kernel : cases) {
        kernel.per_pixel = true;
    }
    cases.push_back(step_case("interpolate", bind_interpolate));
    return cases;
}

}  // namespace disparityd::test
