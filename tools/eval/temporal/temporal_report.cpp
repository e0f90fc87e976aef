// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/temporal/temporal_report.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "base/number_text.h"
#include "pipeline/temporal_stage.h"
#include "tools/command_line/progress.h"
#include "tools/command_line/table.h"
#include "tools/eval/frame_buffers.h"
#include "tools/eval/noise.h"
#include "tools/eval/rendered_scene.h"
#include "tools/eval/seed_argument.h"

namespace disparityd::eval {
namespace {

constexpr int frames = 14;
constexpr int first_judged = 6;
constexpr std::int64_t frame_ns = 33'333'333;
constexpr std::array<double, 3> noises{0, 3, 6};

/// How a sequence moves. The rendered things do where `loop` says how long their way lasts.
struct Motion {
    const char* name;
    int loop = 0;            ///< frames; 0: they stand still
    int turn_px = 0;         ///< by which the picture moves to the left in each frame
    double approach_px = 0;  ///< by which a wall comes nearer in each frame
    bool renders_each() const { return loop > 0; }
};

constexpr std::array motions{Motion{"still"},       Motion{"slow", 190},          Motion{"fast", 48},
                             Motion{"turns", 0, 4}, Motion{"nearer", 0, 0, 0.05}, Motion{"nearer fast", 0, 0, 0.5}};

/// Draws the frames of one sequence.
class Sequence {
public:
    Sequence(const Motion& motion, std::uint32_t seed, double noise)
        : motion_(motion), noise_(noise), scenes_(rendered_scenes(uri(motion, seed))) {}

    Scene read(int index) {
        if (!base_ || motion_.renders_each()) {
            base_ = scenes_[static_cast<std::size_t>(index)].read();
        }
        Scene scene = *base_;
        scene.left = base_->left.clone();
        scene.right = base_->right.clone();
        turn(scene, index * motion_.turn_px);
        if (motion_.approach_px > 0) {
            show_wall(scene, first_disparity + index * motion_.approach_px);
        }
        scene.name += '/' + std::to_string(index);
        add_noise(scene, noise_);
        return scene;
    }

private:
    static constexpr double first_disparity = 10;

    static std::string uri(const Motion& motion, std::uint32_t seed) {
        const std::string loop = std::to_string(motion.renders_each() ? motion.loop : frames);
        return "scene:vga?seed=" + std::to_string(seed) + "&loop=" + loop + "&frames=" + loop;
    }

    /// Cuts a part out of the picture, of the same size at each place.
    void turn(Scene& scene, int x0) const {
        const int width = scene.left.cols - frames * motion_.turn_px;
        const cv::Rect part(x0, 0, width, scene.left.rows);
        const auto cut = [&](auto& values, int type) {
            if (!values.empty()) {
                const cv::Mat all(scene.left.rows, scene.left.cols, type, values.data());
                const cv::Mat some = all(part).clone();
                using Value = typename std::remove_reference_t<decltype(values)>::value_type;
                values.assign(some.ptr<Value>(), some.ptr<Value>() + some.total());
            }
        };
        cut(scene.truth.values, CV_32FC1);
        cut(scene.non_occluded, CV_8UC1);
        scene.truth.width = width;
        scene.right = scene.right(part).clone();
        scene.left = scene.left(part).clone();
    }

    /// Makes the picture that of a plain wall at one distance, with the left eye's texture.
    static void show_wall(Scene& scene, double disparity) {
        const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1, 0, -disparity, 0, 1, 0);
        cv::warpAffine(scene.left, scene.right, shift, scene.left.size(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);
        scene.truth.values.assign(scene.truth.values.size(), static_cast<float>(disparity));
        scene.non_occluded.clear();
    }

    Motion motion_;
    double noise_;
    std::vector<SceneToJudge> scenes_;
    std::optional<Scene> base_;
};

/// Errors of disparities, in px.
struct Errors {
    double measured = 0;
    double wrong = 0;         ///< off by more than 1 px
    double squares = 0;       ///< of those that are not
    double jumped_wrong = 0;  ///< of pixels whose truth has changed by more than 1 px since the frame before
    double variances = 0;     ///< over time, of pixels that were always measured and right

    void add(double error, bool jumped) {
        const bool off = std::abs(error) > 1;
        ++measured;
        wrong += off ? 1 : 0;
        squares += off ? 0 : error * error;
        jumped_wrong += jumped && off ? 1 : 0;
    }
};

struct Counts {
    Errors before, after;
    double jumped = 0;
    double behind = 0;  ///< sum of how much the mean is farther than this frame's own disparity
    double still = 0;   ///< pixels that `variances` has
};

/// The errors of one pixel over time.
struct PixelErrors {
    int frames = 0;
    bool right = true;
    double sum = 0, squares = 0;

    void add(double error) {
        ++frames;
        right = right && std::abs(error) <= 1;
        sum += error;
        squares += error * error;
    }
    double variance() const { return squares / frames - sum / frames * (sum / frames); }
};

void play(const TemporalEvaluation& evaluation, Sequence& sequence, Parallel& workers, Counts& counts) {
    std::unique_ptr<Matcher> matcher;
    std::optional<pipeline::TemporalStage> stage;
    std::vector<PixelErrors> before, after;
    std::vector<float> last_truth;
    for (int i = 0; i < frames; ++i) {
        const Scene scene = sequence.read(i);
        if (!stage) {
            matcher = evaluation.backend->create({scene.left.cols, scene.left.rows, evaluation.match});
            stage.emplace(scene.left.cols, scene.left.rows);
            before.resize(scene.left.total());
            after.resize(scene.left.total());
        }
        FrameBuffers frame(*matcher, scene.left, scene.right, workers);
        frame.match_alone(workers);
        const FrameView& view = frame.view();
        const std::vector<std::int16_t> raw(view.disparity.data, view.disparity.data + scene.left.total());
        stage->run({.view = view, .memory = {}, .monotonic_ns = (i + 1) * frame_ns, .up = {}}, workers);
        for (std::size_t k = 0; i >= first_judged && k < raw.size(); ++k) {
            const double truth = scene.truth.values[k];
            if (view.confidence.data[k] == 0 || !std::isfinite(truth)) {
                continue;
            }
            const bool jumped = std::abs(static_cast<double>(last_truth[k]) - truth) > 1;
            counts.before.add(raw[k] / 16.0 - truth, jumped);
            counts.after.add(view.disparity.data[k] / 16.0 - truth, jumped);
            counts.jumped += jumped ? 1 : 0;
            counts.behind += (raw[k] - view.disparity.data[k]) / 16.0;
            before[k].add(raw[k] / 16.0 - truth);
            after[k].add(view.disparity.data[k] / 16.0 - truth);
        }
        last_truth = scene.truth.values;
    }
    for (std::size_t k = 0; k < before.size(); ++k) {
        if (before[k].frames == frames - first_judged && before[k].right) {
            ++counts.still;
            counts.before.variances += before[k].variance();
            counts.after.variances += after[k].variance();
        }
    }
}

std::string px(double value) {
    return base::fixed(value, 3);
}

std::string ratio(double part, double all, int decimals) {
    return all > 0 ? base::fixed(100 * part / all, decimals) : "-";
}

std::vector<std::string> line(const Motion& motion, double noise, const Counts& counts) {
    const auto sigma = [&](const Errors& of) { return px(std::sqrt(of.variances / counts.still)); };
    const auto error = [](const Errors& of) { return px(std::sqrt(of.squares / (of.measured - of.wrong))); };
    return {motion.name,
            base::fixed(noise, 0),
            sigma(counts.before),
            sigma(counts.after),
            error(counts.before),
            error(counts.after),
            ratio(counts.before.wrong, counts.before.measured, 2),
            ratio(counts.after.wrong, counts.after.measured, 2),
            ratio(counts.before.jumped_wrong, counts.jumped, 2),
            ratio(counts.after.jumped_wrong, counts.jumped, 2),
            px(counts.behind / counts.before.measured)};
}

}  // namespace

std::uint32_t seed_of_sequences(const std::vector<std::string>& data) {
    const auto seed = seed_argument("--temporal-report", "sequences", data);
    if (!seed) {
        throw std::invalid_argument("--temporal-report: found " + data.front() + ", allowed: sequences:SEED");
    }
    return *seed;
}

void report_temporal(const TemporalEvaluation& evaluation, Parallel& workers, bool markdown) {
    tools::Table table({"sequences", "noise", "sigma px", "after", "error px", "after", "wrong %", "after",
                        "of changed wrong %", "after", "behind px"});
    {
        tools::Progress progress("rows", motions.size() * noises.size());
        std::size_t done = 0;
        for (const Motion& motion : motions) {
            for (const double noise : noises) {
                progress.show(done++, motion.name);
                Counts counts;
                for (int i = 0; i < evaluation.sequences; ++i) {
                    Sequence sequence(motion, evaluation.seed + 2 * static_cast<std::uint32_t>(i), noise);
                    play(evaluation, sequence, workers, counts);
                }
                table.add(line(motion, noise, counts));
            }
        }
    }
    markdown ? table.print_markdown(std::cout) : table.print(std::cout);
}

}  // namespace disparityd::eval
