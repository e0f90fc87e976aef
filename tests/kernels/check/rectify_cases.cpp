// SPDX-License-Identifier: Apache-2.0
// Rectification from every pixel format, with maps and without.
#include "kernels/cpu/step_kernels.h"
#include "tests/kernels/check/kernel_case.h"

namespace disparityd::test {
namespace {

/// A captured frame and maps into it: smooth as a camera's, or, hostile, mostly inside, some across the borders, some
/// far outside.
struct RectifyData {
    RectifyData(const KernelInput& from, PixelFormat format, bool mapped)
        : input(from),
          random(from.seed),
          eye_width((from.width + 5) / 2 * 2),
          bytes(noise(random, 2 * eye_width * bytes_per_pixel(format) + 5, from.height + 3)),
          xy(2 * from.width, from.height),
          fraction(from.width, from.height) {
        raw = {bytes.plane().data, format, eye_width, bytes.height(), bytes.width()};
        for (int y = 0; y < input.height; ++y) {
            for (int x = 0; x < input.width; ++x) {
                set_map(x, y);
            }
        }
        const RectifyMap map{std::as_const(xy).plane(), std::as_const(fraction).plane()};
        rectifier = {mapped, map, map, 1, 2};
    }

    void set_map(int x, int y) {
        const bool far = input.hostile && pick(random, 0, 19) == 0;
        const int spread = input.hostile ? 3 : 0;
        xy.at(2 * x, y) = static_cast<std::int16_t>(far ? pick(random, -32768, 32767) : x + pick(random, -spread, 3));
        xy.at(2 * x + 1, y) =
            static_cast<std::int16_t>(far ? pick(random, -32768, 32767) : y + pick(random, -spread, spread));
        fraction.at(x, y) = static_cast<std::uint16_t>(input.hostile ? pick(random, 0, 1023) : (3 * x + 40 * y) & 1023);
        if (!input.hostile) {
            xy.at(2 * x, y) = static_cast<std::int16_t>(x + x / 100);
        }
    }

    KernelInput input;
    Random random;
    int eye_width;
    Image<std::uint8_t> bytes;
    Image<std::int16_t> xy;
    Image<std::uint16_t> fraction;
    RawImage raw;
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
                colour ? steps.rectify_colour(data->raw, Eye::right, data->rectifier, out, rows)
                       : steps.rectify(data->raw, Eye::right, data->rectifier, out, rows);
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
