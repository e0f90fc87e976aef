// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>

#include "kernels/cuda/steps.h"
#include "pipeline/worker_pool.h"
#include "tests/cuda/census_times.h"
#include "tests/cuda/frame_times.h"
#include "tests/cuda/machine_floor.h"

// Times of the back end cuda per step and per frame beside what the device can do at best and beside the back end cpu:
// a table for people and, with a file's name as argument, JSON. tools/gpu-check runs it; every number is a median.
namespace disparityd::test {
namespace {

constexpr int frames = 40;

constexpr std::array<Size, 4> sizes = {
    {{"VGA", 640, 480, 128}, {"Cones", 450, 375, 128}, {"HD720", 1280, 720, 128}, {"HD1080", 1920, 1080, 256}}};

/// Milliseconds of the paper's tables 3 to 5, on a Jetson TK1.
struct PaperScene {
    Size size;
    CensusTimes census_words;
    double sad, census, sgm;
};
constexpr std::array<PaperScene, 4> paper_scenes = {{{{"Cones", 450, 375, 128}, {5.6, 7.7, 2.95}, 30, 12.4, 122},
                                                     {{"Tsukuba", 384, 288, 32}, {3.29, 5.28, 1.86}, 25, 10, 71},
                                                     {{"Teddy", 450, 375, 128}, {6.5, 8.2, 2.3}, 31, 11.4, 130},
                                                     {{"Sawtooth", 434, 380, 32}, {5.22, 7.47, 2.82}, 31, 11.8, 123}}};

// What the design has to do: bytes to and from the device's memory (docs/benchmarks/cuda.md), and packed minima.
struct Work {
    double bytes = 0;
    double minima = 0;
};

Work work_of(const std::string& step, const Size& size, const MatchOptions& options) {
    const double pixels = double(size.width) * size.height;
    const auto cost = options.cost == CensusCost::census_9x7 ? cuda::Cost::census_9x7 : cuda::Cost::census_7x5_gradient;
    const double words = 2 * 8 * cuda::word_size(cost) * pixels;  // of both images
    const cuda::SgmBytes bytes =
        cuda::sgm_bytes(size.width, size.height, size.disparities, options.sgm.paths, options.sgm.p2);
    const auto left_volume = static_cast<double>(bytes.left_volume);
    const double sweep_volumes = 2 * static_cast<double>(bytes.sweep_volume);
    const auto volume = static_cast<double>(cuda::volume_bytes(size.width, size.height, size.disparities));
    const double minima_of_path = 4 * volume / 2;  // for a pair of candidates: two neighbours, jump, penalty, the least
    // Census words are read wherever costs are counted; edges of strips are written and read.
    if (step == "dsi+sweeps") {
        const int paths = options.sgm.paths == 8 ? 6 : 2;
        return {sweep_volumes + 2 * static_cast<double>(bytes.edges) + 2 * words, paths * minima_of_path};
    }
    if (step == "dsi+path") {
        return {left_volume + words, minima_of_path};
    }
    if (step == "dsi+aggregate+wta") {
        return {sweep_volumes + left_volume + words + 7 * pixels, minima_of_path};
    }
    if (step == "guided-median" && options.post.guided_median == 0) {
        return {};
    }
    if (step == "census") {
        return {2 * pixels + words, 0};
    }
    if (step == "dsi+wta") {
        return {words + 7 * pixels, 0};
    }
    constexpr std::array<std::pair<const char*, double>, 6> bytes_per_pixel = {{{"sad+wta", 9},
                                                                                {"rectify", 18},
                                                                                {"left-right+median", 8},
                                                                                {"speckle", 24},
                                                                                {"interpolate+depth", 10},
                                                                                {"guided-median", 7}}};
    for (const auto& [name, per_pixel] : bytes_per_pixel) {
        if (step == name) {
            return {per_pixel * pixels, 0};
        }
    }
    return {};
}

double floor_of(const Work& work, const MachineFloor& machine) {
    return 1e3 * std::max(work.bytes / machine.bytes_per_second, work.minima / machine.max_minima_per_second());
}

/// A JSON list, an object at a time.
class List {
public:
    List(std::ostream& out, const char* name) : out_(out) { out_ << ",\n  \"" << name << "\": ["; }
    ~List() { out_ << "\n  ]"; }
    List(const List&) = delete;
    List& operator=(const List&) = delete;
    std::ostream& next() { return out_ << (std::exchange(first_, false) ? "\n    " : ",\n    "); }

private:
    std::ostream& out_;
    bool first_ = true;
};

/// A method as the daemon offers it: SAD, CENSUS, and SGM in its presets.
struct Chain {
    const char* name;
    MatchOptions options;
};

std::array<Chain, 5> chains(int disparities) {
    const DisparityRange range{0, disparities};
    return {{{"sad", default_options(Method::sad, range)},
             {"census", default_options(Method::census, range)},
             {"paper", preset_options(Preset::paper, range)},
             {"dense", preset_options(Preset::dense, range)},
             {"obstacles", preset_options(Preset::obstacles, range)}}};
}

void time_frame(const Size& size, const Chain& chain, const MachineFloor& machine, Parallel& workers, List& json) {
    const FrameTimes cuda = frame_times("cuda", size, chain.options, frames, workers);
    const double in_flight = two_in_flight("cuda", size, chain.options, frames, workers);
    const FrameTimes cpu = frame_times("cpu", size, chain.options, frames / 4, workers);
    std::printf("%-7s %4dx%-4d D %-3d %-9s %8.3f ms, two in flight %8.3f ms, from rectified %8.3f ms, cpu %8.3f ms\n",
                size.name, size.width, size.height, size.disparities, chain.name, cuda.frame, in_flight, cuda.matched,
                cpu.frame);
    std::ostream& out = json.next();
    out << R"({"size": ")" << size.name << R"(", "disparities": )" << size.disparities << R"(, "chain": ")"
        << chain.name << R"(", "cuda_ms": )" << cuda.frame << R"(, "cuda_in_flight_ms": )" << in_flight
        << R"(, "cuda_matched_ms": )" << cuda.matched << R"(, "cpu_ms": )" << cpu.frame << R"(, "steps_ms": {)";
    double all_floors = 0;
    for (std::size_t i = 0; i < cuda.steps.size(); ++i) {
        // The stage "rectify" is timed with its copies; the kernel has a table of its own.
        const double floor =
            cuda.steps[i] == "rectify" ? 0 : floor_of(work_of(cuda.steps[i], size, chain.options), machine);
        all_floors += floor;
        std::printf("    %-20s %8.3f ms", cuda.steps[i].c_str(), cuda.step[i]);
        std::printf(floor > 0 ? ", floor %8.3f ms: %.0f %% of its speed\n" : "\n", floor, 100 * floor / cuda.step[i]);
        out << (i == 0 ? "" : ", ") << '"' << cuda.steps[i] << "\": " << cuda.step[i];
    }
    std::printf("    floors together            %8.3f ms\n", all_floors);
    out << R"(}, "floor_ms": )" << all_floors << '}';
}

void time_frames(const MachineFloor& machine, Parallel& workers, std::ostream& out) {
    std::printf("\nFrames from YUYV in host memory to results there (cpu: %d workers):\n", workers.workers());
    List json(out, "frames");
    for (const Size& size : sizes) {
        for (const Chain& chain : chains(size.disparities)) {
            time_frame(size, chain, machine, workers, json);
        }
    }
}

void time_rectification(const MachineFloor& machine, std::ostream& out) {
    std::printf("\nRectification alone, from YUYV, all in device memory:\n");
    List json(out, "rectify");
    for (const Size& size : sizes) {
        const double ms = rectify_time(size.width, size.height);
        std::printf("%-8s %8.4f ms, floor %8.4f ms\n", size.name, ms, floor_of(work_of("rectify", size, {}), machine));
        json.next() << R"({"size": ")" << size.name << R"(", "ms": )" << ms << '}';
    }
}

void print_paper_tables(Parallel& workers, std::ostream& out) {
    std::printf(
        "\nThe paper's tables 3 to 5, milliseconds on its Jetson TK1 / here:\n"
        "| scene (D) | census words: global memory | texture memory | shared memory | SAD | CENSUS | SGM |\n"
        "| --- | ---: | ---: | ---: | ---: | ---: | ---: |\n");
    List json(out, "paper_scenes");
    for (const PaperScene& scene : paper_scenes) {
        const Size& size = scene.size;
        const CensusTimes words = census_times(size.width, size.height);
        const auto matched = [&](Method method) {
            const MatchOptions options = default_options(method, {0, size.disparities});
            return frame_times("cuda", size, options, frames, workers).matched;
        };
        const double sad = matched(Method::sad);
        const double census = matched(Method::census);
        const double sgm = matched(Method::sgm);
        std::printf("| %s (%d) | %.2f / %.4f | %.2f / %.4f | %.2f / %.4f | %.0f / %.3f | %.1f / %.3f | %.0f / %.3f |\n",
                    size.name, size.disparities, scene.census_words.global_memory, words.global_memory,
                    scene.census_words.texture_memory, words.texture_memory, scene.census_words.shared_memory,
                    words.shared_memory, scene.sad, sad, scene.census, census, scene.sgm, sgm);
        json.next() << R"({"scene": ")" << size.name << R"(", "census_words_ms": {"global": )" << words.global_memory
                    << R"(, "texture": )" << words.texture_memory << R"(, "shared": )" << words.shared_memory
                    << R"(}, "sad_ms": )" << sad << R"(, "census_ms": )" << census << R"(, "sgm_ms": )" << sgm << '}';
    }
}

void run(std::ostream& json) {
    const MachineFloor machine = measure_floor();
    std::printf(
        "copies: %.0f GB/s, read + written\n"
        "minima of two 16-bit numbers: %.0f G/s as integers, %.0f G/s as f16, %.0f G/s of a sum\n",
        machine.bytes_per_second / 1e9, machine.minima_as_integers_per_second / 1e9,
        machine.minima_as_f16_per_second / 1e9, machine.minima_of_sum_per_second / 1e9);
    json << "{\n  \"bytes_per_second\": " << machine.bytes_per_second
         << ",\n  \"minima_as_integers_per_second\": " << machine.minima_as_integers_per_second
         << ",\n  \"minima_as_f16_per_second\": " << machine.minima_as_f16_per_second
         << ",\n  \"minima_of_sum_per_second\": " << machine.minima_of_sum_per_second;
    pipeline::WorkerPool workers(0);
    time_frames(machine, workers, json);
    time_rectification(machine, json);
    print_paper_tables(workers, json);
    json << "\n}\n";
}

}  // namespace
}  // namespace disparityd::test

int main(int argc, char** argv) {
    if (argc > 2 || (argc == 2 && argv[1][0] == '-')) {
        std::fputs("usage: disparity-cuda-times [FILE]\nTimes of the back end cuda as a table; as JSON to FILE.\n",
                   stderr);
        return 2;
    }
    try {
        std::ofstream json(argc > 1 ? argv[1] : "/dev/null");
        disparityd::test::run(json);
        return json ? 0 : 1;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "disparity-cuda-times: error: %s\n", error.what());
        return 1;
    }
}
