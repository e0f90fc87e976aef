// SPDX-License-Identifier: Apache-2.0
//
// A camera that answers whatever it likes: through the extension unit, and as V4L2 controls.
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <span>

#include <linux/usb/video.h>
#include <linux/uvcvideo.h>
#include <linux/videodev2.h>

#include "capture/camera/camera_controls.h"
#include "capture/camera/zed_extension.h"
#include "tests/fuzz/outcome.h"

using namespace disparityd;

namespace {

/// Every answer is the next bytes of the input, zeros when they are used up.
class Liar final : public capture::VideoSystem {
public:
    explicit Liar(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    std::vector<capture::UsbCamera> cameras() override { return {}; }
    int open(const std::string&) override { return 3; }
    void close(int) override {}
    void* map(int, std::size_t, std::int64_t) override { return nullptr; }
    void unmap(void*, std::size_t) override {}
    base::Wakening wait(int, base::Waker&, std::chrono::steady_clock::time_point) override { return {}; }
    int reset_usb(int, int) override { return EIO; }
    std::chrono::steady_clock::time_point now() override { return {}; }
    std::int64_t realtime_ns() override { return 0; }

    int ioctl(int, unsigned long request, void* argument) override {
        if (request == UVCIOC_CTRL_QUERY) {
            const auto& query = *static_cast<const uvc_xu_control_query*>(argument);
            if (query.query != UVC_SET_CUR) {
                take(query.data, query.size);
            }
        } else if (request == VIDIOC_QUERYCTRL) {
            take(argument, sizeof(v4l2_queryctrl));
            return bytes_.empty() ? EINVAL : 0;
        } else if (request == VIDIOC_G_CTRL || request == VIDIOC_S_CTRL) {
            take(argument, sizeof(v4l2_control));
        }
        std::uint8_t outcome = 0;
        take(&outcome, 1);
        return outcome == 0xff ? EPIPE : 0;
    }

private:
    void take(void* to, std::size_t count) {
        const std::size_t there = std::min(count, bytes_.size());
        std::memset(to, 0, count);
        std::copy_n(bytes_.begin(), there, static_cast<std::uint8_t*>(to));
        bytes_ = bytes_.subspan(there);
    }

    std::span<const std::uint8_t> bytes_;
};

bool is_plain_name(const std::string& name) {
    return std::all_of(name.begin(), name.end(),
                       [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-'; });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::span<const std::uint8_t> bytes(data, size);
    if (const auto answer = capture::zed_answer(bytes, 64)) {
        fuzz::expect(answer->size() == 64, "an answer of another length");
        const std::string serial = capture::zed_serial(*answer);
        fuzz::expect(std::all_of(serial.begin(), serial.end(), [](char c) { return c >= '0' && c <= '9'; }),
                     "a serial number that is none");
    }
    Liar liar(bytes);
    const capture::ZedSerial serial = capture::read_zed_serial(liar, "/dev/video0");
    fuzz::expect(serial.text.size() <= 8 && is_plain_name(serial.text), "a serial number that is none");

    capture::UsbCamera camera;
    camera.vendor = 0x2b03;
    camera.product = 0xf780;
    for (const std::vector<capture::CameraSetting>& settings :
         {std::vector<capture::CameraSetting>{}, {{"gain-left", 30}, {"auto-exposure", 0}}, {{"brightness", 4}}}) {
        Liar again(bytes);
        fuzz::accepted<std::exception>("", [&] {
            try {
                for (const auto& control : capture::control_camera(again, camera, 30, settings)) {
                    fuzz::expect(is_plain_name(control.name), "a control's name is not plain");
                }
            } catch (const capture::ZedError&) {
                // The camera itself refuses.
            } catch (const std::invalid_argument& refusal) {
                fuzz::expect_line(refusal.what(), "camera: ");
            } catch (const std::runtime_error& refusal) {
                fuzz::expect_line(refusal.what(), "camera: ");
            }
        });
    }
    return 0;
}
