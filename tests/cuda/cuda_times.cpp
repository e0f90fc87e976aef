// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>

#include "kernels/cuda/steps.h"
#include "pipeline/worker_pool.h"
#include "tests/cuda/machine_floor.h"
#include "tests/kernels/support.h"

// Times of the back end cuda per step and per frame beside what the device can do at best and beside the back end cpu:
// a table for people and, with a file's name as argument, JSON. tools/gpu-check runs it; every number is a median.
namespace disparityd::test {
namespace {

struct Size {
    const char* name;
    int width, height, disparities;
};
constexpr std::array<Size, 4> sizes = {
    {{"VGA", 640, 480, 128}, {"Cones", 450, 375, 128}, {"HD720", 1280, 720, 128}, {"HD1080", 1920, 1080, 256}}};

// Inputs in rotation, so that no cache holds the next one.
constexpr std::size_t inputs = 4;
constexpr int frames = 40;

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
    return values[values.size() / 2];
}

struct Times {
    std::vector<std::string> steps;
    std::vector<double> milliseconds;  // of each step
    double frame = 0;                  // from rectified pair to results in host memory
};

Times times_of(std::string_view name, const Size& size, Method method, int rounds, Parallel& workers) {
    Random random(1);
    const auto matcher =
        backend(name).create({size.width, size.height, default_options(method, {0, size.disparities})});
    std::vector<std::unique_ptr<Frame>> ring;
    for (std::size_t i = 0; i < inputs; ++i) {
        const auto left = noise(random, size.width, size.height);
        ring.push_back(std::make_unique<Frame>(*matcher, left, shifted(random, left, 10 + static_cast<int>(i))));
    }
    Times result;
    std::vector<std::vector<double>> steps;
    std::vector<double> whole;
    for (int round = 0; round < rounds + 3; ++round) {
        const FrameView& view = ring[static_cast<std::size_t>(round) % inputs]->view;
        std::vector<double> found;
        result.steps.clear();
        const auto begin = std::chrono::steady_clock::now();
        for (std::size_t stage = 1; stage < matcher->stages().size(); ++stage) {
            const auto names = matcher->stages()[stage].steps;
            std::vector<std::chrono::nanoseconds> times(names.size());
            matcher->run(static_cast<int>(stage), view, workers, times);
            for (std::size_t i = 0; i < names.size(); ++i) {
                found.push_back(static_cast<double>(times[i].count()) / 1e6);
                result.steps.emplace_back(names[i]);
            }
        }
        const auto end = std::chrono::steady_clock::now();
        if (round >= 3) {  // the first ones warm up
            whole.push_back(std::chrono::duration<double, std::milli>(end - begin).count());
            steps.resize(found.size());
            for (std::size_t i = 0; i < found.size(); ++i) {
                steps[i].push_back(found[i]);
            }
        }
    }
    for (const auto& step : steps) {
        result.milliseconds.push_back(median(step));
    }
    result.frame = median(whole);
    return result;
}

// What the design has to do: bytes to and from the device's memory, and packed minima. Other steps move a few bytes a
// pixel.
struct Work {
    double bytes = 0;
    double minima = 0;
};

Work work_of(const std::string& step, const Size& size) {
    const double pixels = double(size.width) * size.height;
    const auto volume = static_cast<double>(cuda::volume_bytes(size.width, size.height, size.disparities));
    const double minima_of_path = 4 * volume / 2;  // for a pair of candidates: two neighbours, jump, penalty, the least
    constexpr int stored_paths = 7;
    if (step == "dsi+aggregate") {
        return {stored_paths * volume, stored_paths * minima_of_path};
    }
    if (step == "dsi+aggregate+wta") {
        return {stored_paths * volume + 10 * pixels, minima_of_path};
    }
    return step == "census" ? Work{18 * pixels, 0} : Work{};
}

double floor_of(const Work& work, const MachineFloor& machine) {
    return 1e3 * std::max(work.bytes / machine.bytes_per_second, work.minima / machine.packed_minima_per_second);
}

void write_json(std::ostream& out, const Size& size, Method method, const Times& cuda, double cpu, bool first) {
    out << (first ? "" : ",\n") << R"(    {"size": ")" << size.name << R"(", "disparities": )" << size.disparities
        << R"(, "method": ")" << name(method) << R"(", "cuda_ms": )" << cuda.frame << R"(, "cpu_ms": )" << cpu
        << R"(, "steps_ms": {)";
    for (std::size_t i = 0; i < cuda.steps.size(); ++i) {
        out << (i == 0 ? "" : ", ") << '"' << cuda.steps[i] << "\": " << cuda.milliseconds[i];
    }
    out << "}}";
}

void run(std::ostream& json) {
    const MachineFloor machine = measure_floor();
    std::printf("copies %.0f GB/s (read + written), %.0f G packed minima/s\n\n", machine.bytes_per_second / 1e9,
                machine.packed_minima_per_second / 1e9);
    json << "{\n  \"bytes_per_second\": " << machine.bytes_per_second
         << ",\n  \"packed_minima_per_second\": " << machine.packed_minima_per_second << ",\n  \"frames\": [\n";
    pipeline::WorkerPool workers(0);
    bool first = true;
    for (const Size& size : sizes) {
        for (const Method method : {Method::sad, Method::census, Method::sgm}) {
            const Times cuda = times_of("cuda", size, method, frames, workers);
            const Times cpu = times_of("cpu", size, method, frames / 4, workers);
            std::printf("%-7s %4dx%-4d D %-3d %-7s %8.3f ms, cpu (%d workers) %8.3f ms\n", size.name, size.width,
                        size.height, size.disparities, std::string(name(method)).c_str(), cuda.frame, workers.workers(),
                        cpu.frame);
            for (std::size_t i = 0; i < cuda.steps.size(); ++i) {
                std::printf("    %-20s %8.3f ms, floor %8.3f ms\n", cuda.steps[i].c_str(), cuda.milliseconds[i],
                            floor_of(work_of(cuda.steps[i], size), machine));
            }
            write_json(json, size, method, cuda, cpu.frame, first);
            first = false;
        }
    }
    json << "\n  ]\n}\n";
}

}  // namespace
}  // namespace disparityd::test

int main(int argc, char** argv) {
    try {
        std::ofstream json(argc > 1 ? argv[1] : "/dev/null");
        disparityd::test::run(json);
        return json ? 0 : 1;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "disparity-cuda-times: error: %s\n", error.what());
        return 1;
    }
}
