// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/rectify_stage.h"

#include <string>
#include <vector>

#include "kernels/cuda/device.h"
#include "kernels/cuda/host_planes.h"
#include "kernels/cuda/steps.h"
#include "kernels/frame_stages.h"

namespace disparityd::cuda {

namespace {

Format format_of(PixelFormat format) {
    switch (format) {
        case PixelFormat::yuyv: return Format::yuyv;
        case PixelFormat::bgr24: return Format::bgr24;
        case PixelFormat::grey8: break;
    }
    return Format::grey8;
}

// Maps come rarely: from memory that is not pinned, and waited for.
template <typename T>
void upload_plane(Plane<const T> plane, const DeviceMemory& to, const Stream& stream) {
    std::vector<T> dense(static_cast<std::size_t>(plane.width) * static_cast<std::size_t>(plane.height));
    Serial serial;
    gather(plane, dense.data(), serial);
    check(cudaMemcpyAsync(to.as<void>(), dense.data(), dense.size() * sizeof(T), cudaMemcpyHostToDevice, stream.get()),
          "copying the rectification maps");
    stream.wait("copying the rectification maps");
}

}  // namespace

RectifyStage::RectifyStage(int width, int height) : width_(width), height_(height) {
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    for (std::size_t eye = 0; eye < 2; ++eye) {
        xy_[eye] = DeviceMemory(2 * pixels * sizeof(std::int16_t), "the rectification maps");
        fraction_[eye] = DeviceMemory(pixels * sizeof(std::uint16_t), "the rectification maps");
        out_[eye] = PinnedBuffer(pixels, "the rectified pair");
        colour_[eye] = PinnedBuffer(3 * pixels, "the rectified pair in colour");
    }
}

void RectifyStage::upload_raw(const RawImage& raw, Parallel& workers) {
    const int row_bytes = 2 * raw.eye_width * bytes_per_pixel(raw.format);
    const std::size_t bytes = static_cast<std::size_t>(row_bytes) * static_cast<std::size_t>(raw.height);
    if (raw_.size() != bytes) {
        raw_ = PinnedBuffer(bytes, "the raw frame");
    }
    gather<std::uint8_t>({raw.data, row_bytes, raw.height, raw.stride}, raw_.host<std::uint8_t>(), workers);
    raw_.to_device(stream_);
}

void RectifyStage::upload_maps(const Rectifier& rectifier) {
    if (!rectifier.mapped || (rectifier.id != 0 && rectifier.id == maps_id_)) {
        return;
    }
    maps_id_ = 0;  // until all of them are there
    upload_plane(rectifier.left.xy, xy_[0], stream_);
    upload_plane(rectifier.left.fraction, fraction_[0], stream_);
    upload_plane(rectifier.right.xy, xy_[1], stream_);
    upload_plane(rectifier.right.fraction, fraction_[1], stream_);
    maps_id_ = rectifier.id;
}

void RectifyStage::run(const FrameView& frame, Parallel& workers) {
    check_fits(frame);
    const RawImage& raw = frame.raw;
    const Rectifier& rectifier = *frame.rectifier;
    upload_maps(rectifier);
    upload_raw(raw, workers);
    RectifyJob job{};
    job.raw = raw_.device<const std::uint8_t>();
    job.raw_stride = std::ptrdiff_t{2} * raw.eye_width * bytes_per_pixel(raw.format);
    job.format = format_of(raw.format);
    job.eye_width = raw.eye_width;
    job.raw_height = raw.height;
    for (std::size_t eye = 0; eye < 2; ++eye) {
        job.xy[eye] = rectifier.mapped ? xy_[eye].as<const std::int16_t>() : nullptr;
        job.fraction[eye] = fraction_[eye].as<const std::uint16_t>();
        job.out[eye] = out_[eye].device<std::uint8_t>();
    }
    job.crop_x = rectifier.crop_x;
    job.crop_y = rectifier.crop_y;
    job.width = width_;
    job.height = height_;
    const std::array<Plane<std::uint8_t>, 2> colour{frame.left_colour, frame.right_colour};
    for (std::size_t eye = 0; eye < 2; ++eye) {
        job.colour[eye] = colour[eye] ? colour_[eye].device<std::uint8_t>() : nullptr;
    }
    rectify(job, stream_.get());
    out_[0].to_host(stream_);
    out_[1].to_host(stream_);
    for (std::size_t eye = 0; eye < 2; ++eye) {
        if (colour[eye]) {
            colour_[eye].to_host(stream_);
        }
    }
    stream_.wait("rectification");
    scatter(out_[0].host<const std::uint8_t>(), frame.left, workers);
    scatter(out_[1].host<const std::uint8_t>(), frame.right, workers);
    for (std::size_t eye = 0; eye < 2; ++eye) {
        if (colour[eye]) {
            scatter(colour_[eye].host<const std::uint8_t>(), colour[eye], workers);
        }
    }
}

}  // namespace disparityd::cuda
