// SPDX-License-Identifier: Apache-2.0
// Rectification from every pixel format, with maps and without.
#include "kernels/cpu/step_kernels.h"
#include "tests/kernels/check/kernel_case.h"
#include "tests/kernels/rectify/rectify_inputs.h"

namespace disparityd::test {
namespace {

/// A captured frame and maps into it: as a camera's, or, hostile, of any kind, into a frame of any size.
struct RectifyData {
    RectifyData(const KernelInput& from, PixelFormat format, bool mapped)
        : input(from),
          random(from.seed),
          any_size(from.hostile && mapped),
          source(random, format, any_size ? 2 * pick(random, 1, 150) : (from.width + 5) / 2 * 2,
                 any_size ? pick(random, 1, 90) : from.height + 3),
          left(random, from.width, from.height, source.raw),
          right(random, from.width, from.height, source.raw),
          eye(from.hostile && pick(random, 0, 1) == 0 ? Eye::left : Eye::right) {
        if (!input.hostile) {
            for (int y = 0; y < input.height; ++y) {
                for (int x = 0; x < input.width; ++x) {
                    right.set(x, y, x + x / 100 + 3 * x % 32 / 32.0, y + (3 * x / 32 + y) % 32 / 32.0);
                }
            }
        }
        rectifier = {mapped, left.view(), right.view(), input.hostile ? pick(random, 0, 4) : 1,
                     input.hostile ? pick(random, 0, 3) : 2};
    }

    KernelInput input;
    Random random;
    bool any_size;
    Source source;
    Map left, right;
    Eye eye;
    Rectifier rectifier;
    RunBuffers buffers;
};

KernelCase rectify_case(const std::string& name, PixelFormat format, bool mapped, bool colour) {
    const auto bind = [=](const KernelInput& input, std::int64_t target) {
        const FrameSteps& steps = target == 0 ? reference::steps.frame : cpu::frame_steps(target);
        const auto data = std::make_shared<RectifyData>(input, format, mapped);
        const auto out = data->buffers.result<std::uint8_t>((colour ? 3 : 1) * input.width, input.height);
        const auto run = [=, &steps] {
            over_parts(data->input, [&](Rows rows) {
                colour ? steps.rectify_colour(data->source.raw, data->eye, data->rectifier, out, rows)
                       : steps.rectify(data->source.raw, data->eye, data->rectifier, out, rows);
            });
        };
        return KernelRun{
            run, {}, [data] { return data->buffers.results(); }, [data] { return data->buffers.intact(); }};
    };
    KernelCase kernel{"steps/" + name, bind};
    kernel.per_pixel = true;
    return kernel;
}

}  // namespace

std::vector<KernelCase> rectify_cases() {
    std::vector<KernelCase> cases;
    for (const auto& [format, name] :
         {std::pair{PixelFormat::grey8, "grey"}, {PixelFormat::yuyv, "yuyv"}, {PixelFormat::bgr24, "bgr"}}) {
        const std::string of = std::string("_") + name;
        cases.push_back(rectify_case("rectify" + of, format, true, false));
        cases.push_back(rectify_case("crop" + of, format, false, false));
        cases.push_back(rectify_case("rectify_colour" + of, format, true, true));
    }
    return cases;
}

}  // namespace disparityd::test
