// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "clients/cpp/disparity_client.hpp"
#include "clients/cpp/one_user.h"
#include "clients/cpp/skipped.h"
#include "proto/shared_memory_reader.h"

namespace disparity {
namespace {

namespace proto = disparityd::proto;

void take_over(FrameInfo& frame, const proto::FrameInfo& from, const proto::ShmView& view) {
    proto::copy_frame_fields(frame, from);
    // The size of the planes was checked at opening; the one in the slot was not.
    frame.width = view.width;
    frame.height = view.height;
    frame.region_x = 0;
    frame.region_y = 0;
}

/// Makes room for the wanted planes, in the buffers of the frame read before.
class Planes {
public:
    Planes(Frame& frame, const proto::ShmView& view, const std::vector<Product>& wanted)
        : frame_(frame), view_(view), wanted_(wanted) {}

    std::uint8_t* room_for(const proto::ShmPlane& plane) {
        if (&plane == view_.planes.data()) {
            used_ = 0;
        }
        const auto product = static_cast<Product>(plane.product);
        if (!wanted_.empty() && std::find(wanted_.begin(), wanted_.end(), product) == wanted_.end()) {
            return nullptr;
        }
        if (used_ == frame_.planes.size()) {
            frame_.planes.emplace_back();
        }
        PlaneData& out = frame_.planes[used_++];
        out.product = product;
        const proto::PlaneShape shape = proto::shape_of(view_, plane);
        out.width = shape.width;
        out.height = shape.height;
        out.bytes_per_pixel = shape.bytes_per_pixel;
        out.bytes.resize(plane.bytes);
        return out.bytes.data();
    }

    void finish() { frame_.planes.resize(used_); }

private:
    Frame& frame_;
    const proto::ShmView& view_;
    const std::vector<Product>& wanted_;
    std::size_t used_ = 0;
};

/// A year is longer than any use, and fits in nanoseconds.
std::chrono::milliseconds limited(std::chrono::milliseconds timeout) {
    return std::min<std::chrono::milliseconds>(timeout, std::chrono::hours(24 * 365));
}

ReadResult in_client(proto::ShmReader::Result result) {
    switch (result) {
        case proto::ShmReader::Result::frame: return ReadResult::frame;
        case proto::ShmReader::Result::timeout: return ReadResult::timeout;
        case proto::ShmReader::Result::gone: break;
    }
    return ReadResult::gone;
}

}  // namespace

class BorrowedFrame::Impl {
public:
    proto::BorrowedSlot slot;
};

BorrowedFrame::BorrowedFrame() : impl_(std::make_unique<Impl>()) {}
BorrowedFrame::~BorrowedFrame() = default;
BorrowedFrame::BorrowedFrame(BorrowedFrame&&) noexcept = default;
BorrowedFrame& BorrowedFrame::operator=(BorrowedFrame&&) noexcept = default;

bool BorrowedFrame::whole() const {
    return impl_->slot.whole();
}

class SharedMemoryReader::Impl {
public:
    Impl(const std::string& name, const SharedMemoryOptions& options) : reader_(name, in_proto(options)) {}

    ReadResult read(Frame& frame, std::chrono::milliseconds timeout, const std::vector<Product>& wanted) {
        const OneUser::Call call(user_);
        Planes planes(frame, reader_.view(), wanted);
        proto::FrameInfo head{};
        const auto result = reader_.read(
            head, [&planes](const proto::ShmPlane& plane) { return planes.room_for(plane); }, limited(timeout));
        if (result == proto::ShmReader::Result::frame) {
            planes.finish();
            take_over(frame, head, reader_.view());
            frame.skipped = skipped_.seen(head.publish_index);
            frame.sent_age_ns = head.age_ns - reader_.waited_ns();
        }
        return in_client(result);
    }

    ReadResult borrow(BorrowedFrame& frame, proto::BorrowedSlot& slot, std::chrono::milliseconds timeout) {
        const OneUser::Call call(user_);
        proto::FrameInfo head{};
        frame.planes.clear();
        const auto result = reader_.borrow(head, slot, limited(timeout));
        if (result == proto::ShmReader::Result::frame) {
            for (std::uint32_t i = 0; i < slot.view.plane_count; ++i) {
                const proto::ShmPlane& plane = slot.view.planes[i];
                const auto* bytes =
                    reinterpret_cast<const std::uint8_t*>(proto::plane_words(*slot.slot, slot.view, plane));
                const proto::PlaneShape shape = proto::shape_of(slot.view, plane);
                frame.planes.push_back({static_cast<Product>(plane.product),
                                        shape.width,
                                        shape.height,
                                        shape.bytes_per_pixel,
                                        {bytes, plane.bytes}});
            }
            take_over(frame, head, slot.view);
            frame.skipped = skipped_.seen(head.publish_index);
            frame.sent_age_ns = head.age_ns - reader_.waited_ns();
        }
        return in_client(result);
    }

    std::chrono::nanoseconds heartbeat_age() const { return reader_.heartbeat_age(); }
    const std::string& why_gone() const { return reader_.why_gone(); }

private:
    static proto::ShmReader::Options in_proto(const SharedMemoryOptions& options) {
        proto::ShmReader::Options own;
        own.may_be_absent = options.may_be_absent;
        own.owner = options.owner;
        return own;
    }

    OneUser user_{"SharedMemoryReader", OneUser::After::fork_goes};
    proto::ShmReader reader_;
    SkippedCounter skipped_;
};

SharedMemoryReader::SharedMemoryReader(const std::string& name) : SharedMemoryReader(name, {}) {}
SharedMemoryReader::SharedMemoryReader(const std::string& name, const SharedMemoryOptions& options)
    : impl_(std::make_unique<Impl>(name, options)) {}
SharedMemoryReader::~SharedMemoryReader() = default;
SharedMemoryReader::SharedMemoryReader(SharedMemoryReader&&) noexcept = default;
SharedMemoryReader& SharedMemoryReader::operator=(SharedMemoryReader&&) noexcept = default;

ReadResult SharedMemoryReader::read(Frame& frame, std::chrono::milliseconds timeout,
                                    const std::vector<Product>& wanted) {
    return impl_->read(frame, timeout, wanted);
}

ReadResult SharedMemoryReader::borrow(BorrowedFrame& frame, std::chrono::milliseconds timeout) {
    return impl_->borrow(frame, frame.impl_->slot, timeout);
}

const std::string& SharedMemoryReader::why_gone() const {
    return impl_->why_gone();
}

std::chrono::nanoseconds SharedMemoryReader::heartbeat_age() const {
    return impl_->heartbeat_age();
}

}  // namespace disparity
