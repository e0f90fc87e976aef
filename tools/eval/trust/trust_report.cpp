// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/trust/trust_report.h"

#include <algorithm>
#include <iostream>
#include <memory>

#include <opencv2/core.hpp>

#include "base/number_text.h"
#include "proto/doubt.h"
#include "tools/command_line/progress.h"
#include "tools/command_line/table.h"
#include "tools/eval/frame_buffers.h"
#include "tools/eval/noise.h"
#include "tools/eval/rendered_scene.h"
#include "tools/eval/seed_argument.h"
#include "tools/images/image_file.h"
#include "trust/judge.h"

namespace disparityd::eval {
namespace {

constexpr int rate = 15;
constexpr std::int64_t second_ns = 1'000'000'000;
constexpr int frames_before = 2 * rate;
constexpr int frames_allowed = 5 * rate;
constexpr int frames_of_good = 20 * rate;  // thirty of them are ten minutes
constexpr int different_frames = 8;

std::uint32_t alarm_bits() {
    std::uint32_t bits = 0;
    for (const proto::DoubtFacts& doubt : proto::doubts) {
        bits |= doubt.alarm ? doubt.bit : 0U;
    }
    return bits;
}

/// A pair and what the matcher made of it.
struct MatchedPair {
    cv::Mat left;
    cv::Mat right;
    cv::Mat disparity;
    cv::Mat confidence;

    FrameView view() const {
        const auto plane = [](const cv::Mat& of, auto* data) {
            return Plane<std::remove_pointer_t<decltype(data)>>{data, of.cols, of.rows, of.cols};
        };
        FrameView view;
        view.left = plane(left, left.data);
        view.right = plane(right, right.data);
        view.disparity = plane(disparity, reinterpret_cast<std::int16_t*>(disparity.data));
        view.confidence = plane(confidence, confidence.data);
        return view;
    }
};

/// The scene of one sequence: some frames that are played to and fro.
class Sequence {
public:
    Sequence(const TrustEvaluation& evaluation, std::uint32_t seed)
        : seed_(seed),
          // A robot that stands sees one picture all the time: one of three sequences.
          frames_(seed / 2 % 3 == 2 ? 1 : different_frames),
          scenes_(rendered_scenes("scene:" + evaluation.size + "?seed=" + std::to_string(seed) + "&frames=" +
                                  std::to_string(different_frames) + "&loop=" + std::to_string(different_frames))) {
        for (int i = 0; i < frames_; ++i) {
            Scene scene = scenes_[static_cast<std::size_t>(i)].read();
            change_light(scene);
            pairs_.push_back({scene.left, scene.right, {}, {}});
        }
    }

    cv::Size size() const { return pairs_[0].left.size(); }
    int frames() const { return frames_; }

    std::vector<MatchedPair> with(const MadeFault& fault, Matcher& matcher, Parallel& workers) const {
        std::vector<MatchedPair> made;
        for (int i = 0; i < frames_; ++i) {
            const MatchedPair& pair = pairs_[static_cast<std::size_t>(i)];
            MatchedPair one{pair.left.clone(), pair.right.clone(), {}, {}};
            fault.apply(one.left, one.right, i);
            FrameBuffers frame(matcher, one.left, one.right, workers);
            frame.match(workers);
            const FrameView& view = frame.view();
            one.disparity = cv::Mat(one.left.size(), CV_16SC1, view.disparity.data).clone();
            one.confidence = cv::Mat(one.left.size(), CV_8UC1, view.confidence.data).clone();
            made.push_back(std::move(one));
        }
        return made;
    }

private:
    /// Makes some sequences darker, with noise, and one eye brighter than the other.
    void change_light(Scene& scene) const {
        const std::uint32_t kind = seed_ / 2 % 5;
        const double light = kind == 3 ? 0.35 : kind == 4 ? 0.6 : 1;
        scene.left.convertTo(scene.left, CV_8U, light);
        scene.right.convertTo(scene.right, CV_8U, light * (kind == 1 ? 1.1 : 1));
        if (kind >= 2) {
            add_noise(scene, kind == 2 ? 4 : 2);
        }
    }

    std::uint32_t seed_;
    int frames_;
    std::vector<SceneToJudge> scenes_;
    std::vector<MatchedPair> pairs_;
};

/// Plays frames to and fro, as a camera of `rate` would send them.
class Player {
public:
    explicit Player(cv::Size size) : judge_(size.width, size.height, {}) {}

    std::uint32_t next(const std::vector<MatchedPair>& pairs) {
        const int way = std::max(1, 2 * (static_cast<int>(pairs.size()) - 1));
        const int step = shown_ % way;
        const int index = std::min(step, way - step) % static_cast<int>(pairs.size());
        const trust::Verdict verdict =
            judge_.judge(pairs[static_cast<std::size_t>(index)].view(), shown_ * second_ns / rate, shown_ == 0);
        ++shown_;
        return verdict.doubts & alarm_bits();
    }

private:
    trust::Judge judge_;
    int shown_ = 0;
};

void play_fault(const TrustEvaluation& evaluation, Fault fault, std::uint32_t seed, Parallel& workers,
                TrustCount& count) {
    const Sequence sequence(evaluation, seed);
    const MadeFault made(fault, seed, sequence.size());
    const auto matcher = evaluation.backend->create({sequence.size().width, sequence.size().height, evaluation.match});
    const std::vector<MatchedPair> good = sequence.with({Fault::none, seed, sequence.size()}, *matcher, workers);
    Player player(sequence.size());
    std::uint32_t before = 0;
    const int good_frames = fault == Fault::none ? frames_of_good : frames_before;
    for (int i = 0; i < good_frames; ++i) {
        before |= player.next(good);
    }
    ++count.sequences;
    count.alarms_before += before != 0 ? 1 : 0;
    std::uint32_t others = before;
    int named_at = -1;
    if (fault != Fault::none) {
        const std::vector<MatchedPair> bad = sequence.with(made, *matcher, workers);
        for (int i = 0; i < frames_allowed; ++i) {
            const std::uint32_t alarms = player.next(bad);
            others |= alarms & ~doubt_bit(fault);
            if (named_at < 0 && (alarms & doubt_bit(fault)) != 0) {
                named_at = i;
            }
        }
        count.named += named_at >= 0 ? 1 : 0;
        count.slowest_s = std::max(count.slowest_s, (named_at + 1) / double{rate});
    }
    count.others += others != 0 ? 1 : 0;
    if (others != 0 || (fault != Fault::none && named_at < 0)) {
        count.missed.push_back(std::string(name(fault)) + " seed " + std::to_string(seed) + ": " + made.text() +
                               (fault != Fault::none && named_at < 0 ? ", not named" : "") +
                               (others != 0 ? ", named " + proto::doubt_names(others) : ""));
    }
}

Scene read_pair(const std::string& left, const std::string& right) {
    Scene scene;
    scene.name = left;
    scene.left = images::read_image(left);
    scene.right = images::read_image(right);
    return scene;
}

std::vector<SceneToJudge> real_pairs(const std::vector<std::string>& data) {
    std::vector<SceneToJudge> pairs;
    for (const std::string& one : data) {
        if (const auto comma = one.find(','); comma != std::string::npos) {
            pairs.push_back({one, 0, [one, comma] { return read_pair(one.substr(0, comma), one.substr(comma + 1)); }});
            continue;
        }
        for (const datasets::DatasetScene& files : find_scenes({one})) {
            pairs.push_back(scene_of_files(files, 0, 0));
        }
    }
    return pairs;
}

}  // namespace

TrustCount count_trust(const TrustEvaluation& evaluation, Fault fault, Parallel& workers) {
    TrustCount count;
    tools::Progress progress(name(fault), static_cast<std::size_t>(evaluation.sequences));
    for (int i = 0; i < evaluation.sequences; ++i) {
        progress.show(static_cast<std::size_t>(i), name(fault));
        play_fault(evaluation, fault, evaluation.seed + 2 * static_cast<std::uint32_t>(i), workers, count);
    }
    return count;
}

std::optional<std::uint32_t> seed_of_faults(const std::vector<std::string>& data) {
    return seed_argument("--trust", "faults", data);
}

void report_trust_of_data(const TrustEvaluation& evaluation, const std::vector<std::string>& data, Parallel& workers,
                          bool markdown) {
    tools::Table table({"pair", "trust", "doubts"});
    for (const SceneToJudge& one : real_pairs(data)) {
        Scene scene = one.read();
        MatchOptions match = evaluation.match;
        match.range.count = std::max({match.range.count, scene.disparities, scene.left.cols / 10 / 16 * 16});
        const auto matcher = evaluation.backend->create({scene.left.cols, scene.left.rows, match});
        FrameBuffers frame(*matcher, scene.left, scene.right, workers);
        frame.match(workers);
        trust::Judge judge(scene.left.cols, scene.left.rows, {});
        trust::Verdict last;
        std::uint32_t doubts = 0;
        for (int i = 0; i < frames_of_good; ++i) {
            last = judge.judge(frame.view(), i * second_ns / rate, i == 0);
            doubts |= last.doubts;
        }
        table.add({scene.name, std::to_string(last.trust), proto::doubt_names(doubts)});
    }
    markdown ? table.print_markdown(std::cout) : table.print(std::cout);
}

void report_trust(const TrustEvaluation& evaluation, Parallel& workers, bool markdown) {
    tools::Table table({"sequences", "of each", "named within 5 s", "slowest s", "alarm before", "another alarm"});
    std::vector<std::string> lines;
    for (const Fault fault : {Fault::none, Fault::covered_eye, Fault::dirty_eye, Fault::blurred, Fault::misaligned}) {
        const TrustCount count = count_trust(evaluation, fault, workers);
        const bool good = fault == Fault::none;
        table.add({name(fault), std::to_string(count.sequences), good ? "-" : std::to_string(count.named),
                   good ? "-" : base::fixed(count.slowest_s, 1), std::to_string(count.alarms_before),
                   std::to_string(count.others)});
        lines.insert(lines.end(), count.missed.begin(), count.missed.end());
    }
    markdown ? table.print_markdown(std::cout) : table.print(std::cout);
    for (const std::string& line : lines) {
        std::cout << line << '\n';
    }
}

}  // namespace disparityd::eval
