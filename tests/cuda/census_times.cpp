// SPDX-License-Identifier: Apache-2.0
#include "tests/cuda/census_times.h"

#include <algorithm>
#include <array>
#include <memory>

#include "kernels/cuda/memory.h"
#include "tests/cuda/census_variants.h"
#include "tests/cuda/event_times.h"
#include "tests/kernels/support.h"

namespace disparityd::test {

namespace {

constexpr std::size_t pairs_in_rotation = 4;

std::size_t bytes_of(int width, int height) {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

/// A pair of images of noise in the device's memory, as an array and as textures.
class Pair {
public:
    Pair(Random& random, int width, int height, const cuda::Stream& stream)
        : width_(width), height_(height), textures_{{{width, height}, {width, height}}} {
        for (std::size_t eye = 0; eye < 2; ++eye) {
            images_[eye] = cuda::PinnedBuffer(bytes_of(width, height), "an image");
            std::generate_n(images_[eye].host<std::uint8_t>(), bytes_of(width, height),
                            [&] { return static_cast<std::uint8_t>(random() & 255); });
            images_[eye].to_device(stream);
            textures_[eye].take(image(eye), stream.get());
        }
        stream.wait("the images");
    }
    cuda::View<const std::uint8_t> image(std::size_t eye) const {
        return {images_[eye].device<const std::uint8_t>(), width_, height_, width_};
    }
    const Texture& texture(std::size_t eye) const { return textures_[eye]; }

private:
    int width_;
    int height_;
    std::array<cuda::PinnedBuffer, 2> images_;
    std::array<Texture, 2> textures_;
};

}  // namespace

CensusTimes census_times(int width, int height) {
    Random random(1);
    std::array<cuda::DeviceMemory, 2> words;
    for (cuda::DeviceMemory& memory : words) {
        memory = cuda::DeviceMemory(bytes_of(width, height) * sizeof(std::uint64_t), "the census words");
    }
    std::vector<std::unique_ptr<Pair>> pairs;
    const cuda::Stream stream;
    for (std::size_t i = 0; i < pairs_in_rotation; ++i) {
        pairs.push_back(std::make_unique<Pair>(random, width, height, stream));
    }
    auto* left = words[0].as<std::uint64_t>();
    auto* right = words[1].as<std::uint64_t>();
    const auto milliseconds = [&](auto census_of) {
        return 1e3 * seconds_of(stream, [&](int round) {
                   census_of(*pairs[static_cast<std::size_t>(round) % pairs_in_rotation]);
               });
    };
    return {milliseconds([&](const Pair& pair) {
                census_from_global_memory(pair.image(0), pair.image(1), left, right, stream.get());
            }),
            milliseconds([&](const Pair& pair) {
                census_from_textures(pair.texture(0), pair.texture(1), width, height, left, right, stream.get());
            }),
            milliseconds([&](const Pair& pair) {
                cuda::census(cuda::Cost::census_9x7, pair.image(0), pair.image(1), left, right, stream.get());
            })};
}

double rectify_time(int width, int height) {
    Random random(2);
    const std::size_t pixels = bytes_of(width, height);
    const cuda::PinnedBuffer raw(4 * pixels, "a raw frame");
    const cuda::PinnedBuffer xy(4 * pixels, "a map");
    const cuda::PinnedBuffer fraction(2 * pixels, "a map");
    const std::array<cuda::DeviceMemory, 2> out = {{{pixels, "an image"}, {pixels, "an image"}}};
    const cuda::Stream stream;
    for (std::size_t i = 0; i < pixels; ++i) {
        xy.host<std::int16_t>()[2 * i] = static_cast<std::int16_t>(i % static_cast<std::size_t>(width));
        xy.host<std::int16_t>()[2 * i + 1] = static_cast<std::int16_t>(i / static_cast<std::size_t>(width));
        fraction.host<std::uint16_t>()[i] = static_cast<std::uint16_t>(random() & 1023);
    }
    std::fill_n(raw.host<std::uint8_t>(), 4 * pixels, std::uint8_t{77});
    for (const cuda::PinnedBuffer* memory : {&raw, &xy, &fraction}) {
        memory->to_device(stream);
    }
    cuda::RectifyJob job{};
    job.raw = raw.device<const std::uint8_t>();
    job.raw_stride = 4 * std::ptrdiff_t{width};
    job.format = cuda::Format::yuyv;
    job.eye_width = job.width = width;
    job.raw_height = job.height = height;
    for (std::size_t eye = 0; eye < 2; ++eye) {
        job.xy[eye] = xy.device<const std::int16_t>();
        job.fraction[eye] = fraction.device<const std::uint16_t>();
        job.out[eye] = out[eye].as<std::uint8_t>();
    }
    return 1e3 * seconds_of(stream, [&](int) { cuda::rectify(job, stream.get()); });
}

}  // namespace disparityd::test
