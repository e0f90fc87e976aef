// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/eval_arguments.h"

#include "tools/command_line/number_argument.h"

namespace disparityd::eval {
namespace {

void add_benchmark_arguments(CLI::App& program, EvalArguments& arguments) {
    auto* benchmark = program.add_flag(
        "--benchmark", arguments.benchmark,
        "the figures of the benchmarks instead: bad-0.5 to bad-4.0, D1, mean, RMS, A50 to A99, AUSE, of all pixels, "
        "of those that both cameras see, near edges, of weak texture and, for KITTI 2015, of cars and the rest; each "
        "scene, the mean over scenes, over pixels, and with Middlebury's weights. --output gets a page, index.html");
    for (const char* other : {"--paper", "--fair", "--fractions", "--confidence", "--thin", "--scan", "--trust",
                              "--near-guard-report", "--temporal-report", "--halves"}) {
        benchmark->excludes(other);
    }
    program
        .add_option("--results", arguments.results,
                    "disparity maps of any program, in px: PFM (not finite = no disparity) or KITTI's PNG of 16 bits "
                    "(x 256, 0 = none). A folder, or a pattern with {scene}, or {folder} and {frame}, such as "
                    "out/{scene}.pfm; a scene's name is its folder's, or folder/frame. May be repeated. Nothing is "
                    "matched then unless --method or --opencv is given")
        ->allow_extra_args(false)
        ->type_name("[NAME=]WHERE")
        ->needs(benchmark);
    program
        .add_option("--confidences", arguments.confidences,
                    "their confidences, larger is surer: PFM, or grey images of 8 or 16 bits; NAME as of --results")
        ->allow_extra_args(false)
        ->type_name("[NAME=]WHERE")
        ->needs("--results");
    program
        .add_option("--region", arguments.regions,
                    "only this region: all, nonocc, edges, weak-texture, bg, fg, bg-nonocc or fg-nonocc; may be "
                    "repeated; default: all that are known")
        ->allow_extra_args(false)
        ->type_name("NAME")
        ->needs(benchmark);
    tools::add_choice(program, "--holes", arguments.holes, {"bad", "left-out", "filled"},
                      "pixels without a disparity: bad (as Middlebury counts; the default), left-out, or filled before "
                      "as KITTI fills them; errors in px are always of pixels that have one")
        ->needs(benchmark);
    program.add_flag("--incomplete", arguments.incomplete, "scenes whose result is missing or damaged are left out")
        ->needs(benchmark);
    program.add_flag("--csv", arguments.csv, "the figures as CSV")
        ->needs(benchmark)
        ->excludes("--json")
        ->excludes("--markdown");
}

}  // namespace

void add_arguments(CLI::App& program, EvalArguments& arguments) {
    program
        .add_option(
            "DATA", arguments.data,
            "scene folders with ground truth, or folders of such folders; or a rendered scene, scene:vga?frames=8")
        ->required();
    program
        .add_option("--method", arguments.methods,
                    tools::method_help() + "; all: each of them; may be repeated; default sgm")
        ->allow_extra_args(false)
        ->type_name("METHOD");
    program.add_option("--backend", arguments.backends, tools::backend_help() + "; or all; may be repeated")
        ->allow_extra_args(false)
        ->type_name("NAME");
    auto* opencv = program.add_flag(
        "--opencv", arguments.opencv,
        "also measure OpenCV's StereoBM and StereoSGBM (HH and 3WAY), and count the scenes won: ours at most "
        "the best of OpenCV, both as --fair has them");
    auto* fair = program.add_flag(
        "--fair", arguments.fair,
        "each result twice: as it is, and with every pixel judged (OpenCV on padded images, rejected pixels "
        "filled); bad-1.0, non-occluded");
    auto* paper = program.add_flag(
        "--paper", arguments.paper,
        "table 6 of the paper: bad-1.0, non-occluded, Cones, Tsukuba, Teddy, Sawtooth with 128, 32, 128, 32 "
        "disparities, all methods, whole pixels, rejected pixels filled");
    fair->excludes(paper);
    auto* fractions = program.add_flag(
        "--fractions", arguments.fractions,
        "sub-pixel accuracy instead: bad-0.5, and the share of pixels at most 1/16 px from a whole number");
    fractions->excludes(paper);
    program
        .add_flag(
            "--confidence", arguments.confidence,
            "how often pixels of each confidence are right (off by at most 1 px), and one sigma of the right ones in "
            "px, instead; of each half with --halves")
        ->excludes(paper)
        ->excludes(fair)
        ->excludes(fractions)
        ->excludes(opencv);
    program
        .add_flag("--thin", arguments.thin,
                  "how many pixels of poles and wires of each width are found (at most 1 px off), instead; rendered "
                  "scenes know them")
        ->excludes(paper)
        ->excludes(fair)
        ->excludes(fractions)
        ->excludes("--confidence");
    program
        .add_flag(
            "--scan", arguments.scan,
            "what obstacle scans show, instead. Of made-up courses: DATA is courses:SEED, other seeds give other "
            "courses; --repeat says how many of each kind, default 8. Of courses in bad conditions: conditions:SEED, "
            "--repeat courses in each condition at low, middle and high strength; odd seeds are to tune with, even "
            "ones "
            "to judge with; --output gets pictures of the conditions. Of a robot that drives through courses: "
            "drive:SEED, "
            "--repeat courses, default 100, and with --condition the same in bad conditions; --output gets a picture "
            "of "
            "each clean drive. Of scenes with ground truth and a calibration: "
            "against the scan that the true disparities give. The preset is obstacles unless --preset says otherwise")
        ->excludes(paper)
        ->excludes(fair)
        ->excludes(fractions)
        ->excludes("--thin")
        ->excludes(opencv);
    const auto add_report = [&](const char* name, bool& wanted, const char* help) {
        program.add_flag(name, wanted, help)
            ->excludes(paper)
            ->excludes(fair)
            ->excludes(fractions)
            ->excludes("--thin")
            ->excludes("--scan")
            ->excludes(opencv);
    };
    add_report("--near-guard-report", arguments.near_guard,
               "what the near guard finds, instead: each scene with all candidates that it needs, a half and a "
               "quarter of them. The preset is obstacles unless --preset says otherwise");
    add_report(
        "--temporal-report", arguments.temporal,
        "what the mean over time does, instead: DATA is sequences:SEED, rendered, whose seeds are SEED, SEED + 2 and "
        "so on; --repeat says how many of each kind, default 4. The preset is obstacles unless --preset says "
        "otherwise");
    arguments.scan_options.add_to(program)->needs("--scan");
    add_report(
        "--trust", arguments.trust,
        "how many faulty eyes are named within 5 s, and what false alarms there are, instead. Of made sequences: "
        "DATA is faults:SEED, whose seeds are SEED, SEED + 2 and so on; --repeat says how many of each fault, "
        "default 30. Of real pairs: DATA is folders of scenes, or LEFT,RIGHT. The preset is obstacles unless "
        "--preset says otherwise");
    program
        .add_option("--condition", arguments.conditions,
                    "of conditions:SEED only this condition, such as 'low light'; may be repeated; default all. Of "
                    "drive:SEED this one, too, or all; default none; 'low light:middle' is one strength")
        ->allow_extra_args(false)
        ->type_name("NAME")
        ->needs("--scan");
    tools::add_real(
        program, "--scale", arguments.scale, 0.001, 65535.0,
        "stored value per px of disparity, where the ground truth is 8-bit and its folder has no known name");
    tools::add_integer(program, "--repeat", arguments.repeat, 1, 1000,
                       "runs per scene; the median of their times counts; default 1");
    tools::add_integer(program, "--workers", arguments.workers, 0, 256, "worker threads; default 0: one per core");
    tools::add_integer(
        program, "--halves", arguments.halves, 0, 2147483647,
        "split the scenes at random into two halves, to tune on one and judge on the other: the means of "
        "each half and the names of its scenes; SEED, 0 .. 2147483647: the same seed gives the same halves")
        ->type_name("SEED")
        ->excludes("--thin");
    tools::add_real(
        program, "--noise", arguments.noise, 0, 64,
        "add Gaussian noise to both images before any matching, OpenCV's too; SIGMA in grey levels, 0 .. 64; "
        "each run adds the same noise")
        ->type_name("SIGMA");
    program
        .add_flag("--shared-noise", arguments.shared_noise,
                  "neighbouring pixels share the noise, as a camera's own filter leaves it")
        ->needs("--noise");
    program.add_option("-o,--output", arguments.pictures, "folder for error pictures")->type_name("DIR");
    program.add_flag(
        "--json", arguments.json,
        "a list of objects, one for each line but the means; with --halves an object: rows (this list), "
        "means, won, halves, noise; with --confidence a list of objects: name, calibration_error, "
        "sparsification_area, sigma_px, sigma_px_of_bins (16 numbers), weight and right (256 numbers each); with "
        "--thin a list of objects: name, width (px, 0: more than 6), pixels, found; with --benchmark an object: "
        "holes, rows (a list of objects: row, scene, matcher, region, scenes, pixels and the figures), curves");
    program.add_flag("--markdown", arguments.markdown, "the table in Markdown");
    add_benchmark_arguments(program, arguments);
    arguments.match.add_to(program, "default: what covers the ground truth, or the scene's calib.txt");
}

}  // namespace disparityd::eval
