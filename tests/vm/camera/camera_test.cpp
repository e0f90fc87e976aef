// SPDX-License-Identifier: Apache-2.0
#include <ostream>
#include <thread>

#include <gtest/gtest.h>

#include "tests/vm/camera/commands.h"
#include "tests/vm/camera/descriptors.h"
#include "tests/vm/camera/extension_unit.h"
#include "tests/vm/camera/stream_settings.h"
#include "tests/vm/camera/test_pattern.h"

namespace simulated_camera {

// What ctest lists; found by GoogleTest in the namespace of the types.
static void PrintTo(Link link, std::ostream* out) {
    *out << (link == Link::usb2 ? "usb2" : "usb3");
}
static void PrintTo(Transfer transfer, std::ostream* out) {
    *out << (transfer == Transfer::bulk ? "bulk" : "isochronous");
}

namespace {

using Kind = std::pair<Link, Transfer>;

class Descriptors : public testing::TestWithParam<Kind> {
protected:
    CameraOptions camera() const {
        CameraOptions options;
        options.link = GetParam().first;
        options.transfer = GetParam().second;
        return options;
    }
};

// What a host does: from one to the next by their lengths.
TEST_P(Descriptors, LengthsLeadExactlyToTheEnd) {
    const Bytes all = configuration_descriptor(camera());
    EXPECT_EQ(all.size(), get_little_endian(all, 2, 2));
    std::size_t at = 0;
    while (at < all.size()) {
        ASSERT_GE(all[at], 2) << "at " << at;
        at += all[at];
    }
    EXPECT_EQ(at, all.size());
}

INSTANTIATE_TEST_SUITE_P(Links, Descriptors,
                         testing::Values(Kind{Link::usb2, Transfer::bulk}, Kind{Link::usb3, Transfer::bulk},
                                         Kind{Link::usb2, Transfer::isochronous},
                                         Kind{Link::usb3, Transfer::isochronous}));

TEST(Modes, OnlyTheSmallestOnUsb2AndWithOldFirmware) {
    CameraOptions camera;
    EXPECT_EQ(camera.offered_modes().size(), 4U);
    camera.link = Link::usb2;
    EXPECT_EQ(camera.offered_modes().size(), 1U);
    EXPECT_EQ(camera.offered_modes()[0].width, 1344);
    camera.link = Link::usb3;
    camera.model = find_model("mini-old");
    EXPECT_EQ(camera.offered_modes().size(), 1U);
}

SetupPacket class_request(std::uint8_t request, std::uint8_t selector, std::uint8_t unit, std::uint8_t interface,
                          std::size_t length) {
    const std::uint8_t type = (request & 0x80) != 0 ? 0xa1 : 0x21;
    return {type, request, static_cast<std::uint16_t>(selector << 8), static_cast<std::uint16_t>(unit << 8 | interface),
            static_cast<std::uint16_t>(length)};
}

TEST(StreamSettings, ProposesTheNearestRate) {
    StreamSettings settings{CameraOptions()};
    Bytes wish(34, 0);
    wish[3] = 4;                                          // VGA
    put_little_endian(wish, 4, interval_of_rate(50), 4);  // between 60 and 30
    EXPECT_TRUE(settings.answer(class_request(uvc_request::set_cur, 1, 0, 1, 34), wish));
    const ControlAnswer proposal = settings.answer(class_request(uvc_request::get_cur, 1, 0, 1, 34), {});
    ASSERT_TRUE(proposal);
    EXPECT_EQ(get_little_endian(*proposal, 4, 4), interval_of_rate(60));
    EXPECT_EQ(get_little_endian(*proposal, 18, 4), 2U * 1344 * 376);
    EXPECT_TRUE(settings.answer(class_request(uvc_request::set_cur, 2, 0, 1, 34), *proposal));
    EXPECT_EQ(settings.mode().width, 1344);
    EXPECT_EQ(settings.interval(), interval_of_rate(60));
}

class Extension : public testing::Test {
protected:
    // A read of the flash takes 2 ms.
    Bytes ask(const Bytes& command) {
        EXPECT_TRUE(unit_.answer(class_request(uvc_request::set_cur, 2, 4, 0, command.size()), command));
        std::this_thread::sleep_for(std::chrono::milliseconds(3));
        return unit_.answer(class_request(uvc_request::get_cur, 2, 4, 0, command.size()), {}).value();
    }

    Bytes sensor_command(std::uint8_t operation, std::uint8_t sensor, std::uint16_t address, std::uint8_t value) {
        Bytes command(unit_.command_bytes(), 0);
        command[0] = operation;
        command[1] = sensor;
        command[7] = static_cast<std::uint8_t>(address >> 8);
        command[8] = static_cast<std::uint8_t>(address);
        command[16] = value;
        return command;
    }

    static CameraOptions with_serial() {
        CameraOptions camera;
        camera.serial = 21531;
        return camera;
    }

    ExtensionUnit unit_{with_serial()};
};

TEST_F(Extension, FlashHoldsTheSerialNumberInHexadecimalDigits) {
    Bytes command(unit_.command_bytes(), 0);
    command[0] = 0x51;
    command[1] = 0xa1;
    command[6] = 0x01;
    command[7] = 0x80;
    command[12] = 64;
    const Bytes answer = ask(command);
    EXPECT_EQ(Bytes(answer.begin() + 17, answer.begin() + 23), (Bytes{'O', 'V', 0x00, 0x02, 0x15, 0x31}));
}

TEST_F(Extension, RegistersKeepWhatIsWrittenEachSensorItsOwn) {
    ask(sensor_command(0x50, 0xa3, 0x3501, 0x77));
    ask(sensor_command(0x50, 0xa5, 0x3501, 0x11));
    EXPECT_EQ(ask(sensor_command(0x51, 0xa3, 0x3501, 0))[17], 0x77);
    EXPECT_EQ(ask(sensor_command(0x51, 0xa5, 0x3501, 0))[17], 0x11);
}

TEST_F(Extension, RefusesACommandOfTheWrongLength) {
    const Bytes command(64, 0);
    EXPECT_FALSE(unit_.answer(class_request(uvc_request::set_cur, 2, 4, 0, 64), command));
}

TEST(TestPattern, OneChangedByteIsFound) {
    Bytes frame(1000);
    fill_pattern(0xfedcba98, frame);
    EXPECT_EQ(pattern_number(frame), 0xfedcba98U);
    EXPECT_EQ(first_difference_from_pattern(frame), -1);
    frame[777] ^= 1;
    EXPECT_EQ(first_difference_from_pattern(frame), 777);
}

TEST(Commands, SayWhatIsAllowed) {
    Camera camera(CameraOptions(), [](Link) { return FileDescriptor(); });
    EXPECT_EQ(carry_out(camera, "short 2"), "ok");
    EXPECT_EQ(camera.faults().frames_short, 2);
    EXPECT_EQ(carry_out(camera, "freeze reset"), "ok");
    EXPECT_EQ(camera.faults().frozen, FrozenUntil::usb_reset);
    for (const char* wrong : {"", "err", "explode 3", "plug zed9 1", "freeze forever"}) {
        EXPECT_TRUE(carry_out(camera, wrong).starts_with("error: found '")) << wrong;
    }
}

}  // namespace
}  // namespace simulated_camera
