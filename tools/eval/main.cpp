// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/empty_result/empty_result.h"
#include "capture/scene/scene_source.h"
#include "pipeline/worker_pool.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/match_arguments.h"
#include "tools/command_line/program.h"
#include "tools/command_line/progress.h"
#include "tools/command_line/scan_arguments.h"
#include "tools/eval/benchmark/evaluate_benchmark.h"
#include "tools/eval/conditions/condition_report.h"
#include "tools/eval/confidence/reliability_report.h"
#include "tools/eval/drive/drive_report.h"
#include "tools/eval/eval_arguments.h"
#include "tools/eval/eval_choices.h"
#include "tools/eval/fair_table.h"
#include "tools/eval/frame_buffers.h"
#include "tools/eval/halves.h"
#include "tools/eval/matcher_result.h"
#include "tools/eval/near_guard_report.h"
#include "tools/eval/noise.h"
#include "tools/eval/opencv_matcher.h"
#include "tools/eval/paper.h"
#include "tools/eval/pictures/error_picture.h"
#include "tools/eval/report.h"
#include "tools/eval/scan/data_report.h"
#include "tools/eval/scan/scan_report.h"
#include "tools/eval/scene.h"
#include "tools/eval/subpixel.h"
#include "tools/eval/summary.h"
#include "tools/eval/temporal/temporal_report.h"
#include "tools/eval/thin_widths.h"
#include "tools/eval/trust/trust_report.h"
#include "tools/eval/wins.h"
#include "tools/images/image_file.h"

namespace disparityd::eval {
namespace {

cv::Mat luma_of(const cv::Mat& image) {
    cv::Mat converted = image;
    if (image.channels() == 3) {
        cv::cvtColor(image, converted, cv::COLOR_BGR2GRAY);
    }
    return converted;
}

Plane<const std::uint8_t> view_of(const cv::Mat& image) {
    return {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step)};
}

/// One line for people where hardly a pixel of the scene was measured, with the likely cause; empty otherwise, and of
/// results without confidences.
std::string empty_scene_note(const Scene& scene, const MatcherResult& result) {
    if (result.confidence.empty()) {
        return {};
    }
    const cv::Mat left = luma_of(scene.left), right = luma_of(scene.right);
    empty_result::EmptyResult counted(result.range);
    counted.add(view_of(left), view_of(right), {result.confidence.data(), result.width, result.height, result.width});
    const std::string note = counted.note(std::nullopt);
    return note.empty() ? note : scene.name + ": " + note;
}

class Evaluation {
public:
    explicit Evaluation(const EvalArguments& arguments)
        : arguments_(arguments),
          methods_(methods_of(arguments)),
          backends_(backends_of(arguments)),
          workers_(arguments.workers.value_or(0)),
          repeat_(arguments.repeat.value_or(1)) {
        arguments.match.check_used(methods_);
    }

    void run() {
        check_thin();
        const std::vector<SceneToJudge> scenes = scenes_of(arguments_);
        split(scenes);
        tools::Progress progress("scenes", scenes.size());
        for (std::size_t i = 0; i < scenes.size(); ++i) {
            progress.show(i, scenes[i].name);
            Scene scene = scenes[i].read();
            if (arguments_.noise) {
                add_noise(scene, *arguments_.noise,
                          arguments_.shared_noise ? NoiseKind::shared : NoiseKind::independent);
            }
            judge(scene, scenes[i].disparities);
        }
    }

    const std::vector<Row>& rows() const { return rows_; }
    const std::vector<SubpixelRow>& subpixel_rows() const { return subpixel_rows_; }

    /// For each of our matchers, over all scenes, or over each half.
    std::vector<NamedReliability> reliability() const {
        std::vector<NamedReliability> all;
        for (const SceneReliability& one : scene_reliability_) {
            const std::string half = !halves_ ? "" : halves_->in_a(one.scene) ? ", half a" : ", half b";
            const std::string name = one.matcher + half;
            auto found = std::find_if(all.begin(), all.end(), [&](const auto& has) { return has.name == name; });
            if (found == all.end()) {
                found = all.insert(all.end(), {name, {}, {}});
            }
            found->counted.add(one.counted);
            found->errors.add(one.errors);
        }
        return all;
    }

    const std::vector<NamedThinWidths>& thin_widths() const { return thin_widths_; }

    Summary summary() const {
        Summary summary{
            arguments_.fractions ? measurements(subpixel_rows_) : measurements(rows_), {}, halves_, arguments_.noise};
        if (on_even_terms()) {
            summary.wins = wins(fair_rows_);
        }
        return summary;
    }

private:
    struct SceneReliability {
        std::string scene;
        std::string matcher;
        Reliability counted;
        ErrorSpread errors;
    };

    /// Throws before anything is matched.
    void check_thin() const {
        for (const std::string& data : arguments_.data) {
            if (arguments_.thin && !capture::is_scene(data)) {
                throw std::invalid_argument("--thin: found " + data +
                                            ", which does not say where poles and wires are; allowed: rendered "
                                            "scenes, such as scene:vga");
            }
        }
    }

    void split(const std::vector<SceneToJudge>& scenes) {
        if (arguments_.halves) {
            std::vector<std::string> names;
            for (const SceneToJudge& scene : scenes) {
                names.push_back(scene.name);
            }
            halves_ = split_in_halves(std::move(names), static_cast<std::uint32_t>(*arguments_.halves));
        }
    }

    /// Whether every matcher also runs with every pixel judged: --fair prints it, --opencv counts the scenes won.
    bool on_even_terms() const { return arguments_.opencv || arguments_.fair; }

    void judge(const Scene& scene, int disparities) {
        const int needed = disparities == 0 ? scene.disparities : disparities;
        for (const Method method : methods_) {
            const MatchOptions options = options_for(arguments_, method, needed);
            for (const Backend* backend : backends_) {
                judge_ours(scene, *backend, options);
            }
        }
        if (on_even_terms()) {
            judge_opencv(scene, {arguments_.match.d_min(), arguments_.match.disparities().value_or(needed)});
        }
    }

    void judge_ours(const Scene& scene, const Backend& backend, MatchOptions options) {
        const pipeline::WorkerPool::ComputeSlot slot(workers_);
        const std::string method(to_string(options.method));
        MatcherResult result = run_ours(backend, options, scene.left, scene.right, workers_, repeat_);
        tell_if_empty(scene, result);
        add(scene, method, std::string(backend.name), result);
        if (on_even_terms()) {
            if (!options.post.interpolate || arguments_.fair) {
                options.post.interpolate = true;
                result = run_ours(backend, options, scene.left, scene.right, workers_, fair_repeat());
            }
            add_fair(scene, method, std::string(backend.name), result);
        }
    }

    /// Once for each scene, whatever the number of methods and back ends.
    void tell_if_empty(const Scene& scene, const MatcherResult& result) {
        if (told_as_empty_ == scene.name) {
            return;
        }
        if (const std::string note = empty_scene_note(scene, result); !note.empty()) {
            tools::print_note(note);
            told_as_empty_ = scene.name;
        }
    }

    void judge_opencv(const Scene& scene, DisparityRange range) {
        const int threads = workers_.workers();
        for (const OpencvMethod method : opencv_methods()) {
            add(scene, name(method), "opencv", run_opencv(method, range, scene.left, scene.right, threads, repeat_));
            add_fair(scene, name(method), "opencv",
                     run_opencv_fairly(method, range, scene.left, scene.right, threads, fair_repeat()));
        }
    }

    /// Times of fair results are told with --fair alone.
    int fair_repeat() const { return arguments_.fair ? repeat_ : 1; }

    void add_fair(const Scene& scene, const std::string& method, const std::string& backend,
                  const MatcherResult& result) {
        if (arguments_.fair) {
            add(scene, fair_name(method), backend, result);
            fair_rows_.push_back(rows_.back());
        } else {
            const Accuracy accuracy =
                measure(images::to_float(result.map()), scene.truth, scene.non_occluded, scene.thin);
            fair_rows_.push_back(
                {scene.name, fair_name(method), backend, result.range.count, accuracy, result.ms, result.noise_level});
        }
    }

    void add(const Scene& scene, const std::string& method, const std::string& backend, const MatcherResult& result) {
        const images::FloatMap disparity = images::to_float(result.map());
        const Accuracy accuracy = measure(disparity, scene.truth, scene.non_occluded, scene.thin);
        rows_.push_back({scene.name, method, backend, result.range.count, accuracy, result.ms, result.noise_level});
        if (arguments_.fractions) {
            subpixel_rows_.push_back({scene.name, method, backend, result.range.count,
                                      measure_subpixel(disparity, scene.truth, scene.non_occluded)});
        }
        if (arguments_.confidence && !result.confidence.empty()) {
            SceneReliability one{scene.name, method + " " + backend, {}, {}};
            one.counted.add(disparity, result.confidence, scene.truth);
            one.errors.add(disparity, result.confidence, scene.truth);
            scene_reliability_.push_back(std::move(one));
        }
        if (arguments_.thin) {
            widths_of(method + " " + backend).add(disparity, scene.truth, scene.thin);
        }
        if (!arguments_.pictures.empty()) {
            std::string file = scene.name + '_' + method + '_' + backend + ".png";
            std::replace_if(
                file.begin(), file.end(), [](char c) { return c == ' ' || c == '/'; }, '-');
            images::write_png(arguments_.pictures + '/' + file, error_picture(scene, result));
        }
    }

    ThinWidths& widths_of(const std::string& matcher) {
        for (NamedThinWidths& one : thin_widths_) {
            if (one.name == matcher) {
                return one.widths;
            }
        }
        return thin_widths_.emplace_back(NamedThinWidths{matcher, {}}).widths;
    }

    const EvalArguments& arguments_;
    std::vector<Method> methods_;
    std::vector<const Backend*> backends_;
    pipeline::WorkerPool workers_;
    int repeat_;
    std::vector<Row> rows_;
    std::vector<Row> fair_rows_;  ///< with --opencv or --fair: every pixel judged
    std::vector<SubpixelRow> subpixel_rows_;
    std::vector<SceneReliability> scene_reliability_;
    std::vector<NamedThinWidths> thin_widths_;
    std::optional<Halves> halves_;
    std::string told_as_empty_;  ///< the newest scene of which hardly anything was measured
};

void print_as_json(const Evaluation& evaluation, const EvalArguments& arguments) {
    if (arguments.confidence) {
        print_json(reliability_json(evaluation.reliability()), std::cout);
        return;
    }
    if (arguments.thin) {
        print_json(thin_widths_json(evaluation.thin_widths()), std::cout);
        return;
    }
    nlohmann::ordered_json rows =
        arguments.fractions ? subpixel_json(evaluation.subpixel_rows()) : rows_json(evaluation.rows());
    if (!arguments.halves) {
        print_json(rows, std::cout);
        return;
    }
    nlohmann::ordered_json all{{"rows", std::move(rows)}};
    all.update(summary_json(evaluation.summary()));
    print_json(all, std::cout);
}

void print_as_text(const Evaluation& evaluation, const EvalArguments& arguments) {
    if (arguments.confidence) {
        print_reliability(evaluation.reliability(), arguments.markdown, std::cout);
        return;
    }
    if (arguments.thin) {
        print_thin_widths(evaluation.thin_widths(), arguments.markdown, std::cout);
        return;
    }
    const std::vector<Row>& rows = evaluation.rows();
    const Summary summary = evaluation.summary();
    if (arguments.fractions) {
        print_subpixel_table(evaluation.subpixel_rows(), arguments.markdown, std::cout);
    } else if (arguments.paper) {
        print_paper_table(rows, arguments.markdown, std::cout);
    } else if (arguments.fair) {
        print_fair_table(rows, arguments.markdown, std::cout);
        std::cout << '\n';
        print_means(summary.measured, arguments.markdown, std::cout);
    } else {
        print_table(rows, arguments.markdown, std::cout);
    }
    print_summary(summary, arguments.markdown, std::cout);
}

ScanOptions scan_options(const EvalArguments& arguments, const MatchOptions& match) {
    return arguments.scan_options.options(match.method == Method::sgm && match.sgm.calibrated_confidence);
}

int evaluate_data_scans(const EvalArguments& arguments, Parallel& workers) {
    DataEvaluation evaluation;
    evaluation.scenes = scenes_to_scan(arguments.data, arguments.scale.value_or(0));
    const Method method = methods_of(arguments).front();
    evaluation.match = [&arguments, method](int disparities) { return options_for(arguments, method, disparities); };
    evaluation.scan = scan_options(arguments, evaluation.match(64));
    evaluation.backend = backends_of(arguments).front();
    report_data_scans(evaluation, workers, arguments.markdown);
    return tools::exit_done;
}

/// How made-up courses are matched and scanned.
ScanSettings scan_settings(const EvalArguments& arguments) {
    constexpr int disparities = 64;
    const MatchOptions match =
        options_for(arguments, methods_of(arguments).front(), arguments.match.disparities().value_or(disparities));
    return {match, scan_options(arguments, match), backends_of(arguments).front()};
}

/// What is to be done with made-up courses in bad conditions: scan them, or drive through them.
template <typename Evaluation>
Evaluation course_evaluation(const EvalArguments& arguments, std::uint32_t seed) {
    Evaluation evaluation;
    evaluation.settings = scan_settings(arguments);
    evaluation.seed = seed;
    evaluation.courses = arguments.repeat.value_or(evaluation.courses);
    evaluation.names = arguments.conditions;
    evaluation.pictures = arguments.pictures;
    return evaluation;
}

int evaluate_scans(const EvalArguments& arguments) {
    pipeline::WorkerPool workers(arguments.workers.value_or(0));
    const pipeline::WorkerPool::ComputeSlot slot(workers);
    const std::optional<std::uint32_t> conditions_seed = seed_of_conditions(arguments.data);
    const std::optional<std::uint32_t> drive_seed = seed_of_drives(arguments.data);
    if (!arguments.conditions.empty() && !conditions_seed && !drive_seed) {
        throw std::invalid_argument("--condition: found '" + arguments.data.front() +
                                    "' as DATA, allowed: conditions:SEED, such as conditions:1, and drive:SEED");
    }
    if (drive_seed) {
        report_drives(course_evaluation<DriveEvaluation>(arguments, *drive_seed), workers, arguments.markdown);
        return tools::exit_done;
    }
    if (conditions_seed) {
        report_conditions(course_evaluation<ConditionEvaluation>(arguments, *conditions_seed), workers,
                          arguments.markdown);
        return tools::exit_done;
    }
    const std::optional<std::uint32_t> seed = seed_of_courses(arguments.data);
    if (!seed) {
        return evaluate_data_scans(arguments, workers);
    }
    ScanEvaluation evaluation;
    evaluation.settings = scan_settings(arguments);
    evaluation.seed = *seed;
    evaluation.courses_per_kind = arguments.repeat.value_or(evaluation.courses_per_kind);
    evaluation.pictures = arguments.pictures;
    report_scans(evaluation, workers, arguments.markdown);
    return tools::exit_done;
}

int evaluate_trust(const EvalArguments& arguments) {
    pipeline::WorkerPool workers(arguments.workers.value_or(0));
    const pipeline::WorkerPool::ComputeSlot slot(workers);
    constexpr int disparities = 64;
    TrustEvaluation evaluation;
    evaluation.match =
        options_for(arguments, methods_of(arguments).front(), arguments.match.disparities().value_or(disparities));
    evaluation.backend = backends_of(arguments).front();
    evaluation.sequences = arguments.repeat.value_or(evaluation.sequences);
    if (const auto seed = seed_of_faults(arguments.data)) {
        evaluation.seed = *seed;
        report_trust(evaluation, workers, arguments.markdown);
    } else {
        report_trust_of_data(evaluation, arguments.data, workers, arguments.markdown);
    }
    return tools::exit_done;
}

int evaluate_temporal(const EvalArguments& arguments) {
    pipeline::WorkerPool workers(arguments.workers.value_or(0));
    const pipeline::WorkerPool::ComputeSlot slot(workers);
    TemporalEvaluation evaluation;
    evaluation.match = options_for(arguments, methods_of(arguments).front(), 64);
    evaluation.backend = backends_of(arguments).front();
    evaluation.sequences = arguments.repeat.value_or(evaluation.sequences);
    evaluation.seed = seed_of_sequences(arguments.data);
    report_temporal(evaluation, workers, arguments.markdown);
    return tools::exit_done;
}

int evaluate_near_guard(const EvalArguments& arguments) {
    pipeline::WorkerPool workers(arguments.workers.value_or(0));
    const pipeline::WorkerPool::ComputeSlot slot(workers);
    const Method method = methods_of(arguments).front();
    NearGuardEvaluation evaluation;
    evaluation.scenes = scenes_of(arguments);
    evaluation.match = [&arguments, method](int disparities) { return options_for(arguments, method, disparities); };
    evaluation.backend = backends_of(arguments).front();
    report_near_guard(evaluation, workers, arguments.markdown);
    return tools::exit_done;
}

int evaluate(EvalArguments arguments) {
    if (!arguments.pictures.empty()) {
        std::error_code error;
        std::filesystem::create_directories(arguments.pictures, error);
        if (error) {
            throw std::runtime_error(arguments.pictures + ": " + error.message());
        }
    }
    if (arguments.benchmark) {
        evaluate_benchmark(std::move(arguments));
        return tools::exit_done;
    }
    if (arguments.methods.empty()) {
        arguments.methods = {arguments.paper ? "all" : "sgm"};
    }
    if (arguments.backends.empty()) {
        arguments.backends = {"auto"};
    }
    if (arguments.scan || arguments.near_guard || arguments.trust || arguments.temporal) {
        arguments.match.set_usual(Preset::obstacles);
        return arguments.scan         ? evaluate_scans(arguments)
               : arguments.near_guard ? evaluate_near_guard(arguments)
               : arguments.trust      ? evaluate_trust(arguments)
                                      : evaluate_temporal(arguments);
    }
    Evaluation evaluation(arguments);
    evaluation.run();
    arguments.json ? print_as_json(evaluation, arguments) : print_as_text(evaluation, arguments);
    return tools::exit_done;
}

}  // namespace

}  // namespace disparityd::eval

int main(int argc, char** argv) {
    using namespace disparityd;
    CLI::App program("Measures disparity against ground truth: bad pixels, density, time.", "disparity-eval");
    program.footer(
        "bad-x: share of the pixels with known truth whose disparity is more than x px from it, rejected pixels "
        "included;\n"
        "D1: the same, but bad is off by more than 3 px and by more than 5 % of the truth (KITTI).\n"
        "nonocc: only those that both cameras see. density: share of the pixels with known truth that have a "
        "disparity.\n"
        "false near: of these, the ones that read nearer than they are, by more than 3 px and more than 5 %.\n"
        "thin: share of the pixels on poles and wires whose disparity is at most 1 px off (rendered scenes).\n"
        "mean: over the scenes, each counts the same; a scene where a figure is not known does not count.\n"
        "ms: matching and post-processing of a rectified pair. Scenes: folders as Middlebury, ETH3D, KITTI, Sintel,\n"
        "SceneFlow and DrivingStereo have them, and frames of scene: with their exact truth.\n"
        "--benchmark: avg (EPE) and RMS are means of |disparity - truth|; A90: what 90 % of the pixels do not exceed; "
        "AUSE:\n"
        "what is lost by removing pixels by their confidence instead of their error. docs/evaluation.md has all.\n"
        "Exit status: 0 done; 1 the system refused; 2 arguments or data must be changed.\n"
        "Example: disparity-eval --method all --opencv --repeat 5 data/middlebury2003\n"
        "Example: disparity-eval --benchmark --results OTHER=out/{scene}.pfm -o page MiddEval3/trainingQ");
    eval::EvalArguments arguments;
    eval::add_arguments(program, arguments);
    return tools::run_program(program, argc, argv, [&arguments] { return eval::evaluate(arguments); });
}
