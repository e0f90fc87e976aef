// SPDX-License-Identifier: Apache-2.0
#include <functional>
#include <stdexcept>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include "tests/proto/collect.h"
#include "tests/proto/pattern.h"

namespace proto = disparityd::proto;
using Result = proto::ShmReader::Result;
using namespace std::chrono_literals;

namespace {

/// An object under our name that anybody may have made.
class HostileMemory : public testing::Test {
protected:
    std::string name_ = pattern::unique_name("hostile", ::getpid());
    std::string object_ = "/disparityd." + name_;
    proto::ShmLayout layout_ = pattern::layout(64, 32);

    void TearDown() override { ::shm_unlink(object_.c_str()); }

    /// Writes to the header of the object behind the writer's back.
    void damage(const std::function<void(proto::ShmHeader&)>& change) {
        const int fd = ::shm_open(object_.c_str(), O_RDWR, 0);
        ASSERT_GE(fd, 0);
        void* memory = ::mmap(nullptr, sizeof(proto::ShmHeader), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
        ::close(fd);
        ASSERT_NE(memory, MAP_FAILED);
        change(*static_cast<proto::ShmHeader*>(memory));
        ::munmap(memory, sizeof(proto::ShmHeader));
    }

    void make(const std::string& content) {
        const int fd = ::shm_open(object_.c_str(), O_RDWR | O_CREAT | O_EXCL, 0600);
        ASSERT_GE(fd, 0);
        ASSERT_EQ(::write(fd, content.data(), content.size()), static_cast<ssize_t>(content.size()));
        ::close(fd);
    }

    std::string refusal() {
        try {
            proto::ShmReader reader(name_);
        } catch (const std::runtime_error& error) {
            return error.what();
        }
        return "accepted";
    }
};

TEST_F(HostileMemory, EachDamagedFieldIsRefused) {
    const std::vector<std::pair<const char*, std::function<void(proto::ShmHeader&)>>> cases{
        {"magic", [](auto& h) { h.magic = 1; }},
        {"version", [](auto& h) { h.version = 77; }},
        {"header_bytes 0", [](auto& h) { h.header_bytes = 0; }},
        {"header_bytes huge", [](auto& h) { h.header_bytes = ~0U; }},
        {"total_bytes", [](auto& h) { h.total_bytes = ~0ULL; }},
        {"slot_count 0", [](auto& h) { h.slot_count = 0; }},
        {"slot_count huge", [](auto& h) { h.slot_count = ~0U; }},
        {"slot_count 60", [](auto& h) { h.slot_count = 60; }},
        {"plane_count", [](auto& h) { h.plane_count = 9; }},
        {"slots_offset huge", [](auto& h) { h.slots_offset = ~0ULL - 63; }},
        {"slots_offset odd", [](auto& h) { h.slots_offset += 4; }},
        {"slots_offset in header", [](auto& h) { h.slots_offset = 0; }},
        {"slot_stride huge", [](auto& h) { h.slot_stride = ~0ULL - 63; }},
        {"slot_stride 0", [](auto& h) { h.slot_stride = 0; }},
        {"payload_offset huge", [](auto& h) { h.payload_offset = ~0ULL - 63; }},
        {"payload_offset 0", [](auto& h) { h.payload_offset = 0; }},
        {"width 0", [](auto& h) { h.width = 0; }},
        {"width huge", [](auto& h) { h.width = ~0U; }},
        {"height", [](auto& h) { h.height = 16384; }},
        {"bytes_per_pixel", [](auto& h) { h.planes[0].bytes_per_pixel = 4; }},
        {"plane offset", [](auto& h) { h.planes[1].offset = ~0ULL - 63; }},
        {"plane bytes", [](auto& h) { h.planes[2].bytes = 1ULL << 40; }},
    };
    for (const auto& [what, change] : cases) {
        proto::SharedMemoryWriter writer(name_, layout_);
        EXPECT_EQ(refusal(), "accepted");
        damage(change);
        const std::string text = refusal();
        EXPECT_THAT(text, testing::HasSubstr("shared memory " + object_ + " ")) << what;
        EXPECT_NE(text, "accepted") << what;
    }
}

TEST_F(HostileMemory, MorePlanesNeedTheirVersionAndHeader) {
    for (std::uint32_t product = 10; layout_.planes.size() < 9; ++product) {
        layout_.planes.push_back({product, 1});
    }
    const std::vector<std::pair<const char*, std::function<void(proto::ShmHeader&)>>> cases{
        {"version", [](auto& h) { h.version = 1; }},
        {"header_bytes", [](auto& h) { h.header_bytes = 320; }},
        {"plane_count", [](auto& h) { h.plane_count = 17; }},
        {"plane bytes", [](auto& h) { h.more_planes[0].bytes = 1ULL << 40; }},
    };
    for (const auto& [what, change] : cases) {
        proto::SharedMemoryWriter writer(name_, layout_);
        EXPECT_EQ(refusal(), "accepted");
        damage(change);
        EXPECT_THAT(refusal(), testing::HasSubstr("is damaged")) << what;
    }
}

TEST_F(HostileMemory, VersionIsNamed) {
    proto::SharedMemoryWriter writer(name_, layout_);
    damage([](auto& h) { h.version = 77; });
    EXPECT_THAT(refusal(), testing::HasSubstr("layout version 77, this program knows 1"));
}

TEST_F(HostileMemory, TooSmallOrForeignObjectsAreRefusedAndReplaced) {
    for (const std::string& content :
         {std::string(), std::string(100, 'x'), std::string("<!DOCTYPE html>"), std::string(100000, '\0')}) {
        make(content);
        EXPECT_NE(refusal(), "accepted") << content.size();
        proto::SharedMemoryWriter writer(name_, layout_);
        EXPECT_THAT(writer.note(), testing::HasSubstr("replaced shared memory " + object_)) << content.size();
        EXPECT_EQ(refusal(), "accepted") << content.size();
    }
}

TEST_F(HostileMemory, LiesAfterMappingLeadNowhere) {
    proto::SharedMemoryWriter writer(name_, layout_);
    pattern::Source source(layout_);
    writer.publish(pattern::head(1, layout_), source.make(1));
    proto::ShmReader reader(name_);
    damage([](auto& h) {
        h.slot_stride = ~0ULL;
        h.slots_offset = ~0ULL;
        h.width = ~0U;
        h.planes[0].bytes = ~0ULL;
        h.published_total = ~0ULL;
        h.heartbeat_ns = std::numeric_limits<std::int64_t>::min();
    });
    // Which frame comes is the liar's choice; that only memory of the object is read is ours (address sanitizer).
    Collected got;
    EXPECT_NE(got.read(reader, 0ms), Result::timeout);
    EXPECT_EQ(got.read(reader, 20s), Result::gone);
}

TEST_F(HostileMemory, SlotThatIsAlwaysBeingWrittenEndsInATimeout) {
    proto::SharedMemoryWriter writer(name_, layout_);
    pattern::Source source(layout_);
    writer.publish(pattern::head(1, layout_), source.make(1));
    proto::ShmReader reader(name_);
    const int fd = ::shm_open(object_.c_str(), O_RDWR, 0);
    ASSERT_GE(fd, 0);
    const std::uint64_t odd = 12345;
    ASSERT_EQ(::pwrite(fd, &odd, sizeof odd, static_cast<off_t>(reader.view().slots_offset)), 8);
    ::close(fd);
    Collected got;
    EXPECT_EQ(got.read(reader, 30ms), Result::timeout);
}

}  // namespace
