// SPDX-License-Identifier: Apache-2.0
// Every function of KernelSteps but rectification: what an instruction set's table has against the reference's.
#include "kernels/cpu/step_kernels.h"
#include "kernels/parallel.h"
#include "tests/kernels/check/kernel_case.h"

namespace disparityd::test {
namespace {

/// What a step works on: contents drawn from the input's seed, planes that it writes.
struct StepData {
    explicit StepData(const KernelInput& from) : input(from), random(from.seed) {}

    const MatchOptions& options() const { return input.options; }
    DisparityRange range() const { return input.options.range; }
    std::int16_t invalid() const { return invalid_disparity(range()); }
    std::size_t pixels() const {
        return static_cast<std::size_t>(input.width) * static_cast<std::size_t>(input.height);
    }
    std::size_t candidates() const { return pixels() * static_cast<std::size_t>(range().count); }

    /// Values from 0 to `most`, or fewer different ones, so that many are equal.
    template <typename T>
    std::vector<T> values(std::size_t count, int most) {
        const int kind = input.hostile ? pick(random, 0, 3) : 3;
        const int spread = kind == 0 ? 0 : kind == 1 ? std::min(3, most) : most;
        const int least = kind == 1 ? most - spread : 0;
        std::vector<T> all(count);
        for (T& value : all) {
            value = static_cast<T>(pick(random, least, least + spread));
        }
        return all;
    }
    template <typename T>
    Volume<T> volume(std::vector<T>& of) const {
        return {of.data(), input.width, input.height, range().count};
    }

    /// Disparities as winner-takes-all and checks leave them: patches with some noise and holes.
    Image<std::int16_t> disparities() {
        Image<std::int16_t> image(input.width, input.height);
        const int noise = input.hostile ? pick(random, 0, 40) : 4;
        const int holes = input.hostile ? 30 * pick(random, 0, 3) : 10;
        int patch = 16 * range().first;
        for (std::int16_t& value : image.pixels()) {
            if (pick(random, 0, 14) == 0) {
                patch = 16 * (range().first + pick(random, 0, range().count - 1));
            }
            value = static_cast<std::int16_t>(patch + pick(random, -noise, noise));
            value = pick(random, 0, 99) < holes ? invalid() : value;
        }
        return image;
    }
    /// Winners in whole pixels; of the right image some pixels have none.
    Image<std::int16_t> winners(bool right) {
        Image<std::int16_t> image(input.width, input.height);
        const int spread = input.hostile && pick(random, 0, 1) == 0 ? 2 : range().count - 1;
        for (std::int16_t& value : image.pixels()) {
            value = static_cast<std::int16_t>(range().first + pick(random, right ? -1 : 0, spread));
        }
        return image;
    }

    KernelInput input;
    Random random;
    RunBuffers buffers;
};

using Data = std::shared_ptr<StepData>;
/// A step bound to its data, and what has to be put back before it runs again.
struct Bound {
    std::function<void(const KernelSteps&)> run;
    std::function<void()> prepare;
};

/// `bind(data, steps)` draws the contents; `own` tells whether a table has a function other than the reference's.
KernelCase step_case(const std::string& name, std::function<Bound(const Data&, const KernelSteps&)> bind,
                     std::function<bool(const KernelSteps&)> own) {
    const auto bind_variant = [bind](const KernelInput& input, std::int64_t target) {
        const KernelSteps& steps = target == 0 ? reference::steps : cpu::steps(target);
        const auto data = std::make_shared<StepData>(input);
        const Bound bound = bind(data, steps);
        return KernelRun{[bound, &steps, data] { bound.run(steps); }, bound.prepare,
                         [data] { return data->buffers.results(); }, [data] { return data->buffers.intact(); }};
    };
    return {"steps/" + name, bind_variant, [own](std::int64_t target) { return own(cpu::steps(target)); }};
}

template <auto member>
bool own(const KernelSteps& steps) {
    return steps.*member != reference::steps.*member;
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

Bound bind_sad(const Data& data, const KernelSteps&) {
    const auto pair = std::make_shared<ImagePair>(data->random, data->input);
    const auto costs = data->buffers.memory<std::uint16_t>(data->candidates(), true);
    const Volume<std::uint16_t> volume{costs.data(), data->input.width, data->input.height, data->range().count};
    return {[=](const KernelSteps& steps) {
                over_parts(data->input, [&](Rows rows) {
                    steps.sad(pair->left.plane(), pair->right.plane(), data->range(), volume, rows);
                });
            },
            {}};
}

Bound bind_census(const Data& data, const KernelSteps&) {
    const auto pair = std::make_shared<ImagePair>(data->random, data->input);
    const auto words = data->buffers.result<std::uint64_t>(data->input.width, data->input.height);
    return {[=](const KernelSteps& steps) {
                over_parts(data->input, [&](Rows rows) { steps.census(pair->left.plane(), words, rows); });
            },
            {}};
}

Bound bind_matching_cost(const Data& data, const KernelSteps&) {
    ImagePair pair(data->random, data->input);
    const auto left = std::make_shared<Image<std::uint64_t>>(data->input.width, data->input.height);
    const auto right = std::make_shared<Image<std::uint64_t>>(data->input.width, data->input.height);
    reference::census(pair.left.plane(), left->plane(), left->rows());
    reference::census(pair.right.plane(), right->plane(), right->rows());
    const auto costs = data->buffers.memory<std::uint8_t>(data->candidates(), true);
    const Volume<std::uint8_t> volume{costs.data(), data->input.width, data->input.height, data->range().count};
    return {[=](const KernelSteps& steps) {
                over_parts(data->input, [&](Rows rows) {
                    steps.matching_cost(left->plane(), right->plane(), data->range(), volume, rows);
                });
            },
            {}};
}

Bound bind_aggregate(const Data& data, const KernelSteps& steps_to_run) {
    const auto pair = std::make_shared<ImagePair>(data->random, data->input);
    const auto costs = std::make_shared<std::vector<std::uint8_t>>(data->values<std::uint8_t>(data->candidates(), 62));
    const auto sums = data->buffers.memory<std::uint16_t>(data->candidates(), true);
    const auto scratch = data->buffers.memory<std::byte>(
        steps_to_run.aggregate_scratch(data->input.width, data->input.height, data->range().count));
    return {[=](const KernelSteps& steps) {
                Serial serial;
                steps.aggregate(data->volume(*costs), pair->left.plane(), data->options().sgm,
                                {sums.data(), data->input.width, data->input.height, data->range().count}, scratch,
                                serial);
            },
            {}};
}

/// The largest cost that steps after it can meet: of census, of 8 paths with the largest P2.
template <typename T>
constexpr int most_cost = sizeof(T) == 1 ? 62 : 8 * (62 + 193);

template <typename T>
const WinnerSteps<T>& winner_steps(const KernelSteps& steps) {
    if constexpr (sizeof(T) == 1) {
        return steps.winner_u8;
    } else {
        return steps.winner_u16;
    }
}

template <typename T>
Bound bind_winner_left(const Data& data, const KernelSteps&) {
    const auto costs = std::make_shared<std::vector<T>>(data->values<T>(data->candidates(), most_cost<T>));
    const auto winner = data->buffers.result<std::int16_t>(data->input.width, data->input.height);
    const auto disparity = data->buffers.result<std::int16_t>(data->input.width, data->input.height);
    return {[=](const KernelSteps& steps) {
                over_parts(data->input, [&](Rows rows) {
                    winner_steps<T>(steps).left(data->volume(*costs), data->range(), data->options().post.subpixel,
                                                winner, disparity, rows);
                });
            },
            {}};
}

template <typename T>
Bound bind_winner_right(const Data& data, const KernelSteps&) {
    const auto costs = std::make_shared<std::vector<T>>(data->values<T>(data->candidates(), most_cost<T>));
    const auto winner = data->buffers.result<std::int16_t>(data->input.width, data->input.height);
    return {[=](const KernelSteps& steps) {
                over_parts(data->input, [&](Rows rows) {
                    winner_steps<T>(steps).right(data->volume(*costs), data->range(), winner, rows);
                });
            },
            {}};
}

template <typename T>
Bound bind_local_extrema(const Data& data, const KernelSteps&) {
    const auto costs = std::make_shared<std::vector<T>>(data->values<T>(data->candidates(), most_cost<T>));
    const auto winner = std::make_shared<Image<std::int16_t>>(data->input.width, data->input.height);
    Image<std::int16_t> start(data->input.width, data->input.height);
    reference::winner_left<T>(data->volume(*costs), data->range(), true, winner->plane(), start.plane(), start.rows());
    const auto disparity = data->buffers.result<std::int16_t>(data->input.width, data->input.height);
    const auto confidence = data->buffers.result<std::uint8_t>(data->input.width, data->input.height);
    return {[=](const KernelSteps& steps) {
                over_parts(data->input, [&](Rows rows) {
                    winner_steps<T>(steps).local_extrema(data->volume(*costs), data->range(), data->options().post,
                                                         winner->plane(), disparity, confidence, rows);
                });
            },
            put_back(start, disparity)};
}

Bound bind_left_right(const Data& data, const KernelSteps&) {
    const auto left = std::make_shared<Image<std::int16_t>>(data->winners(false));
    const auto right = std::make_shared<Image<std::int16_t>>(data->winners(true));
    const auto disparity = data->buffers.result<std::int16_t>(data->input.width, data->input.height);
    return {[=](const KernelSteps& steps) {
                over_parts(data->input, [&](Rows rows) {
                    steps.left_right(left->plane(), right->plane(), data->range(), disparity, rows);
                });
            },
            put_back(data->disparities(), disparity)};
}

template <int size>
Bound bind_median(const Data& data, const KernelSteps&) {
    const auto in = std::make_shared<Image<std::int16_t>>(data->disparities());
    const auto out = data->buffers.result<std::int16_t>(data->input.width, data->input.height);
    return {[=](const KernelSteps& steps) {
                over_parts(data->input,
                           [&](Rows rows) { steps.median(in->plane(), data->invalid(), size, out, rows); });
            },
            {}};
}

Bound bind_speckle(const Data& data, const KernelSteps& steps_to_run) {
    const auto disparity = data->buffers.result<std::int16_t>(data->input.width, data->input.height);
    const auto scratch =
        data->buffers.memory<std::byte>(steps_to_run.speckle_scratch(data->input.width, data->input.height));
    const int least = data->input.hostile ? pick(data->random, 1, 60) : 100;
    const int step = data->input.hostile ? pick(data->random, 0, 40) : 16;
    return {[=](const KernelSteps& steps) {
                Serial one;
                steps.speckle(disparity, data->invalid(), least, step, scratch, one);
            },
            put_back(data->disparities(), disparity)};
}

Bound bind_mask_confidence(const Data& data, const KernelSteps&) {
    const auto disparity = std::make_shared<Image<std::int16_t>>(data->disparities());
    const auto confidence = data->buffers.result<std::uint8_t>(data->input.width, data->input.height);
    return {[=](const KernelSteps& steps) {
                over_parts(data->input, [&](Rows rows) {
                    steps.mask_confidence(disparity->plane(), data->invalid(), confidence, rows);
                });
            },
            put_back(noise(data->random, data->input.width, data->input.height), confidence)};
}

Bound bind_interpolate(const Data& data, const KernelSteps& steps_to_run) {
    const auto right = std::make_shared<Image<std::int16_t>>(data->winners(true));
    const auto disparity = data->buffers.result<std::int16_t>(data->input.width, data->input.height);
    const auto scratch =
        data->buffers.memory<std::byte>(steps_to_run.interpolate_scratch(data->input.width, data->input.height));
    return {[=](const KernelSteps& steps) {
                Serial one;
                steps.interpolate(disparity, right->plane(), data->range(), scratch, one);
            },
            put_back(data->disparities(), disparity)};
}

Bound bind_depth(const Data& data, const KernelSteps&) {
    const auto disparity = std::make_shared<Image<std::int16_t>>(data->disparities());
    const auto depth = data->buffers.result<std::uint16_t>(data->input.width, data->input.height);
    DepthScale scale{672000, 3};
    if (data->input.hostile) {
        scale = {pick(data->random, 0, 3) * std::int64_t{1} * pick(data->random, 0, 100000000),
                 pick(data->random, -3000, 3000)};
    }
    return {[=](const KernelSteps& steps) {
                over_parts(data->input,
                           [&](Rows rows) { steps.depth(disparity->plane(), data->invalid(), scale, depth, rows); });
            },
            {}};
}

template <typename T>
void add_winner_cases(std::vector<KernelCase>& cases, const std::string& type) {
    const auto of = [](const KernelSteps& steps) -> const WinnerSteps<T>& { return winner_steps<T>(steps); };
    cases.push_back(step_case("winner_left_" + type, bind_winner_left<T>,
                              [of](const KernelSteps& steps) { return of(steps).left != of(reference::steps).left; }));
    cases.push_back(step_case("winner_right_" + type, bind_winner_right<T>, [of](const KernelSteps& steps) {
        return of(steps).right != of(reference::steps).right;
    }));
    cases.push_back(step_case("local_extrema_" + type, bind_local_extrema<T>, [of](const KernelSteps& steps) {
        return of(steps).local_extrema != of(reference::steps).local_extrema;
    }));
}

}  // namespace

std::vector<KernelCase> step_cases() {
    std::vector<KernelCase> cases;
    cases.push_back(step_case("sad", bind_sad, own<&KernelSteps::sad>));
    cases.push_back(step_case("matching_cost", bind_matching_cost, own<&KernelSteps::matching_cost>));
    cases.push_back(step_case("aggregate", bind_aggregate, own<&KernelSteps::aggregate>));
    cases.back().four_paths = true;
    add_winner_cases<std::uint8_t>(cases, "u8");
    add_winner_cases<std::uint16_t>(cases, "u16");
    cases.push_back(step_case("interpolate", bind_interpolate, own<&KernelSteps::interpolate>));
    const std::size_t per_pixel = cases.size();
    cases.push_back(step_case("census", bind_census, own<&KernelSteps::census>));
    cases.push_back(step_case("left_right", bind_left_right, own<&KernelSteps::left_right>));
    cases.push_back(step_case("median3", bind_median<3>, own<&KernelSteps::median>));
    cases.push_back(step_case("median5", bind_median<5>, own<&KernelSteps::median>));
    cases.push_back(step_case("speckle", bind_speckle, own<&KernelSteps::speckle>));
    cases.push_back(step_case("mask_confidence", bind_mask_confidence, own<&KernelSteps::mask_confidence>));
    cases.push_back(step_case("depth", bind_depth, own<&KernelSteps::depth>));
    for (std::size_t i = per_pixel; i < cases.size(); ++i) {
        cases[i].per_pixel = true;
    }
    return cases;
}

}  // namespace disparityd::test
