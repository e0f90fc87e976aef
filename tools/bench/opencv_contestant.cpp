// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/opencv_contestant.h"

#include <limits>
#include <sstream>
#include <utility>

#include <opencv2/core/utility.hpp>

#include "tools/bench/allocation_meter.h"

namespace disparityd::bench {
namespace {

class OpencvContestant final : public Contestant {
public:
    OpencvContestant(cv::Ptr<cv::StereoMatcher> matcher, const StereoPair& pair)
        : matcher_(std::move(matcher)), left_(pair.left), right_(pair.right) {}

    void prepare() override { cv::setNumThreads(threads); }
    void run() override { matcher_->compute(left_, right_, disparity_); }

private:
    cv::Ptr<cv::StereoMatcher> matcher_;
    cv::Mat left_, right_, disparity_;
};

std::string trimmed(const std::string& text) {
    const std::size_t first = text.find_first_not_of(' ');
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

/// What stands after "key:" in OpenCV's description of its build; empty where it says nothing.
std::string build_fact(const std::string& key) {
    std::istringstream lines(cv::getBuildInformation());
    for (std::string line; std::getline(lines, line);) {
        const std::string text = trimmed(line);
        if (text.rfind(key + ':', 0) == 0) {
            return trimmed(text.substr(key.size() + 1));
        }
    }
    return {};
}

/// The best instruction set that all of OpenCV is compiled for: its matchers have no code for others.
std::string baseline() {
    const std::string sets = build_fact("Baseline");
    const std::size_t last = sets.find_last_of(' ');
    return sets.empty() ? "unknown" : last == std::string::npos ? sets : sets.substr(last + 1);
}

}  // namespace

std::string contestant_name(eval::OpencvMethod method) {
    switch (method) {
        case eval::OpencvMethod::bm: return "opencv/bm";
        case eval::OpencvMethod::sgbm_hh: return "opencv/hh";
        case eval::OpencvMethod::sgbm_3way: return "opencv/3way";
    }
    return {};
}

Contestants make_opencv(const StereoPair& pair, eval::OpencvMethod method, int d_min, const std::vector<int>& threads) {
    const bool one_thread = method == eval::OpencvMethod::sgbm_hh;
    Contestants all;
    for (const int count : one_thread ? std::vector<int>{1} : threads) {
        const AllocationMeter meter;
        auto one = std::make_unique<OpencvContestant>(eval::create_opencv(method, {d_min, pair.disparities}), pair);
        one->name = contestant_name(method);
        one->isa = baseline();
        one->threads = count;
        one->prepare();
        one->run();
        const auto bytes = meter.peak_bytes();
        one->memory_mb = bytes ? static_cast<double>(*bytes) / 1e6 : std::numeric_limits<double>::quiet_NaN();
        all.push_back(std::move(one));
    }
    return all;
}

std::vector<std::string> describe_opencv() {
    const auto fact = [](const std::string& key) {
        const std::string found = build_fact(key);
        return found.empty() ? "not said" : found;
    };
    return {"OpenCV " + std::string(CV_VERSION) + ": baseline " + fact("Baseline") + "; dispatched " +
                fact("Dispatched code generation") + " (its matchers are compiled for the baseline only); threads: " +
                fact("Parallel framework") + "; StereoSGBM MODE_HH runs on one thread",
            "OpenCV leaves out the left D - 1 columns (of 450 columns with D = 128 it computes 323), ours and naive "
            "compute all; GDE/s counts all columns for everybody"};
}

}  // namespace disparityd::bench
