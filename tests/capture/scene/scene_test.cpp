// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <thread>

#include "capture/frame_source.h"
#include "capture/scene/scene_options.h"
#include "capture/scene/scene_render.h"
#include "tests/capture/images/image_fixture.h"

namespace disparityd::capture {
namespace {

using test::refusal;
using test::soon;
using testing::AllOf;
using testing::HasSubstr;
using Next = FrameSource::Next;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

SourceOptions offline_scene(const std::string& uri) {
    SourceOptions options;
    options.uri = uri;
    options.pace = Pace::fastest;
    return options;
}

std::vector<std::uint8_t> bytes_of(const RawImage& image) {
    return {image.data, image.data + image.stride * image.height};
}

std::vector<std::vector<std::uint8_t>> frames_of(const std::string& uri, int count) {
    const auto source = open_source(offline_scene(uri));
    std::vector<std::vector<std::uint8_t>> frames;
    for (int i = 0; i < count; ++i) {
        RawFrame frame;
        if (source->next(frame, soon()) != Next::frame) {
            throw std::runtime_error("the scene ended early");
        }
        frames.push_back(bytes_of(frame.image));
        source->give_back(frame);
    }
    return frames;
}

double difference(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); i += 2) {
        sum += std::abs(a[i] - b[i]);
    }
    return 2 * sum / static_cast<double>(a.size());
}

TEST(SceneUri, ModesRatesAndParameters) {
    const SceneOptions vga = parse_scene_uri("scene:vga@15");
    EXPECT_EQ(vga.width, 672);
    EXPECT_EQ(vga.height, 376);
    EXPECT_EQ(vga.rate, 15);
    const SceneOptions hd = parse_scene_uri("scene:HD720@12.5?frames=60&seed=7&loop=5&width=640&height=361");
    EXPECT_EQ(hd.width, 640);
    EXPECT_EQ(hd.height, 361);
    EXPECT_EQ(hd.rate, 12.5);
    EXPECT_EQ(hd.frames, 60U);
    EXPECT_EQ(hd.seed, 7U);
    EXPECT_EQ(hd.loop, 5);
    EXPECT_EQ(parse_scene_uri("scene:hd1080").width, 1920);
    const SceneOptions large = parse_scene_uri("scene:hd2k");
    EXPECT_EQ(large.height, 1242);
    EXPECT_LE(4LL * large.width * large.height * large.loop, 256LL << 20);
}

TEST(SceneUri, SaysWhatIsAllowed) {
    const auto said = [](const std::string& uri) { return refusal([&] { open_source(offline_scene(uri)); }); };
    EXPECT_THAT(said("scene:8k"), AllOf(HasSubstr("8k"), HasSubstr("hd720")));
    EXPECT_THAT(said("scene:vga@0"), HasSubstr("rate"));
    EXPECT_THAT(said("scene:vga@fast"), AllOf(HasSubstr("rate"), HasSubstr("fast")));
    EXPECT_THAT(said("scene:vga@"), HasSubstr("rate"));
    EXPECT_THAT(said("scene:vga?width=641"), AllOf(HasSubstr("width"), HasSubstr("even")));
    EXPECT_THAT(said("scene:vga?height=-3"), HasSubstr("height"));
    EXPECT_THAT(said("scene:vga?frames=0"), HasSubstr("frames"));
    EXPECT_THAT(said("scene:vga?colour=red"), AllOf(HasSubstr("colour"), HasSubstr("seed")));
    EXPECT_THAT(said("scene:hd2k?loop=1000"), HasSubstr("memory"));
    EXPECT_THAT(said("scene:vga?width=9999999999"), HasSubstr("width"));
}

TEST(Scene, SameSeedSameBytes) {
    const std::string uri = "scene:vga?width=160&height=90&loop=3";
    const auto once = frames_of(uri, 3);
    EXPECT_EQ(once, frames_of(uri, 3));
    EXPECT_NE(once, frames_of(uri + "&seed=2", 3));
    EXPECT_NE(once[0], once[1]);
}

TEST(Scene, OneThatStartsAgainNeverEnds) {
    SourceOptions options;
    options.uri = "scene:vga?width=160&height=90&loop=2&frames=3";
    options.pace = Pace::fastest;
    options.loop = true;
    const auto source = open_source(options);
    EXPECT_FALSE(source->info().frame_count);
    for (int i = 0; i < 10; ++i) {
        RawFrame frame;
        ASSERT_EQ(source->next(frame, std::chrono::steady_clock::now() + std::chrono::seconds(60)),
                  FrameSource::Next::frame);
        EXPECT_EQ(frame.sequence, static_cast<std::uint64_t>(i));
        source->give_back(frame);
    }
}

TEST(Scene, TheLoopHasNoJump) {
    constexpr int loop = 16;
    const auto frames = frames_of("scene:vga?width=160&height=90&loop=16", loop + 1);
    EXPECT_EQ(frames[loop], frames[0]);
    double largest = 0;
    for (int i = 1; i < loop; ++i) {
        largest =
            std::max(largest, difference(frames[static_cast<std::size_t>(i)], frames[static_cast<std::size_t>(i) - 1]));
    }
    EXPECT_LT(difference(frames[0], frames[loop - 1]), 1.2 * largest);
    EXPECT_GT(largest, 1.5) << "something moves, not noise alone";
}

TEST(Scene, OfflineTimesAreThoseOfAnIdealClockAndTheSceneEnds) {
    const auto source = open_source(offline_scene("scene:vga@25?width=64&height=36&frames=5&loop=2"));
    const SourceInfo& info = source->info();
    EXPECT_EQ(info.format, PixelFormat::yuyv);
    EXPECT_EQ(info.eye_width, 64);
    EXPECT_EQ(info.height, 36);
    EXPECT_EQ(info.rate, 25);
    EXPECT_FALSE(info.live);
    EXPECT_EQ(info.frame_count, 5U);
    ASSERT_TRUE(info.calibration);
    EXPECT_EQ(info.calibration->width, 64);
    RawFrame frame;
    for (int i = 0; i < 5; ++i) {
        ASSERT_EQ(source->next(frame, soon()), Next::frame);
        EXPECT_EQ(frame.sequence, static_cast<std::uint64_t>(i));
        EXPECT_EQ(frame.monotonic_ns, i * 40'000'000LL);
        EXPECT_EQ(frame.realtime_ns - frame.monotonic_ns, 1'577'836'800'000'000'000);
        EXPECT_EQ(frame.dropped_before, 0U);
        source->give_back(frame);
    }
    EXPECT_EQ(source->next(frame, soon()), Next::end);
    EXPECT_EQ(source->next(frame, soon()), Next::end);
}

TEST(Scene, AtItsOwnPaceLikeACamera) {
    SourceOptions options = offline_scene("scene:vga@50?width=64&height=36&loop=2");
    options.pace = Pace::source;
    const auto source = open_source(options);
    EXPECT_TRUE(source->info().live);
    RawFrame frame;
    ASSERT_EQ(source->next(frame, soon()), Next::frame);
    source->give_back(frame);
    std::int64_t last = frame.monotonic_ns;
    for (int i = 0; i < 4; ++i) {
        ASSERT_EQ(source->next(frame, soon()), Next::frame);
        source->give_back(frame);
        EXPECT_GE(steady_clock::now().time_since_epoch().count(), frame.monotonic_ns) << "not before its time";
        EXPECT_EQ(frame.monotonic_ns - last, 20'000'000 * (1 + static_cast<std::int64_t>(frame.dropped_before)));
        last = frame.monotonic_ns;
    }
}

TEST(Scene, TimesOutUntilTheNextFrameIsDue) {
    SourceOptions options = offline_scene("scene:vga@0.1?width=64&height=36&loop=2");
    options.pace = Pace::source;
    const auto source = open_source(options);
    RawFrame frame;
    ASSERT_EQ(source->next(frame, soon()), Next::frame);
    source->give_back(frame);
    EXPECT_EQ(source->next(frame, steady_clock::now()), Next::timeout) << "the next frame is 10 s away";
}

TEST(Scene, FramesThatNobodyTakesAreLostAndCounted) {
    SourceOptions options = offline_scene("scene:vga@1000?width=64&height=36&loop=2");
    options.pace = Pace::source;
    const auto source = open_source(options);
    RawFrame frame;
    ASSERT_EQ(source->next(frame, soon()), Next::frame);
    source->give_back(frame);
    std::uint64_t expected = frame.sequence;
    const std::int64_t start = frame.monotonic_ns;
    std::uint64_t lost = 0;
    for (int i = 0; i < 3; ++i) {
        std::this_thread::sleep_for(milliseconds(50));
        ASSERT_EQ(source->next(frame, soon()), Next::frame);
        source->give_back(frame);
        lost += frame.dropped_before;
        expected += 1 + frame.dropped_before;
        EXPECT_EQ(frame.sequence, expected);
        EXPECT_EQ(frame.monotonic_ns - start, static_cast<std::int64_t>(frame.sequence) * 1'000'000);
    }
    EXPECT_GE(lost, 3U * 40U);
}

TEST(Scene, LoansAreBoundedAndComeBackFromAnotherThread) {
    SourceOptions options = offline_scene("scene:vga?width=64&height=36&loop=4");
    options.loans = 2;
    const auto source = open_source(options);
    RawFrame first, second, third;
    ASSERT_EQ(source->next(first, soon()), Next::frame);
    ASSERT_EQ(source->next(second, soon()), Next::frame);
    EXPECT_EQ(source->next(third, steady_clock::now() + milliseconds(5)), Next::timeout);
    std::thread other([&] { source->give_back(first); });
    EXPECT_EQ(source->next(third, soon()), Next::frame);
    other.join();
    EXPECT_EQ(third.sequence, 2U);
}

TEST(Scene, InterruptEndsTheWait) {
    SourceOptions options = offline_scene("scene:vga?width=64&height=36&loop=2");
    options.loans = 1;
    const auto source = open_source(options);
    RawFrame frame;
    ASSERT_EQ(source->next(frame, soon()), Next::frame);
    std::thread other([&] { source->interrupt(); });
    EXPECT_EQ(source->next(frame, soon()), Next::interrupted);
    other.join();
    EXPECT_EQ(source->next(frame, soon()), Next::interrupted);
}

struct Stop {};

TEST(Scene, PreparationReportsAndCanBeGivenUp) {
    SourceOptions options = offline_scene("scene:vga?width=64&height=36&loop=9");
    int last = -1;
    options.progress = [&](int done, int total) {
        EXPECT_EQ(total, 9);
        EXPECT_GE(done, last);
        last = done;
    };
    open_source(options);
    EXPECT_EQ(last, 9);
    options.progress = [](int, int) { throw Stop(); };
    EXPECT_THROW(open_source(options), Stop);
}

/// Asks for a stop at the given row, the first is 1, and counts the rows that are begun.
class StopAtRow {
public:
    explicit StopAtRow(int row) : stop_at_(row) {}
    void operator()() {
        if (++rows_ == stop_at_) {
            throw Stop();
        }
    }
    int rows() const { return rows_; }

private:
    const int stop_at_;
    int rows_ = 0;
};

SceneOptions small_scene() {
    return parse_scene_uri("scene:vga?width=64&height=36&loop=2");
}

TEST(SceneRenderer, AStopEndsTheRaysAtTheRowAtHand) {
    for (const int row : {1, 20, 36, 37, 72}) {
        StopAtRow stop(row);
        EXPECT_THROW(SceneRenderer(small_scene(), std::ref(stop)), Stop) << row;
        EXPECT_EQ(stop.rows(), row);
    }
    StopAtRow never(0);
    SceneRenderer(small_scene(), std::ref(never));
    EXPECT_EQ(never.rows(), 2 * 36) << "each row of each eye";
}

TEST(SceneRenderer, AStopEndsTheDrawingAtTheRowAtHand) {
    const SceneRenderer renderer(small_scene());
    std::vector<std::uint8_t> whole(renderer.frame_bytes());
    renderer.render(1, whole.data(), [] {});
    constexpr std::size_t eye_row = 2 * 64;
    const std::vector<std::uint8_t> untouched(eye_row, 0xEE);
    for (const int row : {1, 20, 36, 37, 72}) {
        std::vector<std::uint8_t> cut(renderer.frame_bytes(), 0xEE);
        StopAtRow stop(row);
        EXPECT_THROW(renderer.render(1, cut.data(), std::ref(stop)), Stop);
        EXPECT_EQ(stop.rows(), row);
        // Rows are drawn one eye after the other; in memory they stand side by side.
        for (int drawn = 1; drawn <= 2 * 36; ++drawn) {
            const bool right = drawn > 36;
            const std::size_t y = static_cast<std::size_t>(drawn - 1) % 36;
            const std::size_t first = y * 2 * eye_row + (right ? eye_row : 0);
            const std::uint8_t* expected = drawn < row ? whole.data() + first : untouched.data();
            EXPECT_TRUE(std::equal(expected, expected + eye_row, cut.data() + first)) << row << ' ' << drawn;
        }
    }
}

// Whoever asks for a stop throws from `progress`. The rays come first, and each of their rows asks.
TEST(Scene, AStopEndsThePreparationAtTheRowAtHand) {
    SourceOptions options = offline_scene("scene:vga?width=64&height=36&loop=2");
    for (const int row : {1, 20, 36, 37, 72}) {
        StopAtRow stop(row);
        options.progress = [&](int, int) { stop(); };
        EXPECT_THROW(open_source(options), Stop) << row;
        EXPECT_EQ(stop.rows(), row);
    }
}

/// Luma of one eye at a place of the rectified image, bilinear both times; NaN outside.
class RectifiedEye {
public:
    RectifiedEye(const RawImage& raw, Eye eye, const RectifyMap& map) : map_(map), raw_(raw), eye_(raw.eye(eye)) {}

    double at(int x, int y) const {
        if (x < 0 || x >= map_.fraction.width) {
            return std::nan("");
        }
        const int column = map_.xy.at(2 * x, y);
        const int row = map_.xy.at(2 * x + 1, y);
        if (column < 0 || row < 0 || column + 1 >= raw_.eye_width || row + 1 >= raw_.height) {
            return std::nan("");
        }
        const int fraction = map_.fraction.at(x, y);
        const double a = (fraction & 31) / 32.0;
        const double b = (fraction >> 5) / 32.0;
        const auto luma = [&](int u, int v) { return static_cast<double>(eye_.at(2 * u, v)); };
        return (1 - b) * ((1 - a) * luma(column, row) + a * luma(column + 1, row)) +
               b * ((1 - a) * luma(column, row + 1) + a * luma(column + 1, row + 1));
    }
    double at(double x, int y) const {
        const double column = std::floor(x);
        const int first = static_cast<int>(column);
        return (1 - (x - column)) * at(first, y) + (x - column) * at(first + 1, y);
    }

private:
    RectifyMap map_;
    RawImage raw_;
    Plane<const std::uint8_t> eye_;
};

/// The median over visible pixels of the difference between the left image and the right one `shift` px beside the
/// place that the ground truth names.
double median_difference(const RawImage& raw, const calibration::Rectification& rectification, const SceneTruth& truth,
                         bool visible, double shift) {
    const Rectifier rectifier = rectification.rectifier();
    const RectifiedEye left(raw, Eye::left, rectifier.left);
    const RectifiedEye right(raw, Eye::right, rectifier.right);
    std::vector<double> differences;
    for (int y = 0; y < rectification.height; ++y) {
        for (int x = 0; x < rectification.width; ++x) {
            const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(rectification.width) +
                           static_cast<std::size_t>(x);
            if ((truth.visible[i] != 0) == visible) {
                const double d =
                    std::abs(left.at(x, y) - right.at(x - static_cast<double>(truth.disparity[i]) + shift, y) / 1.02);
                if (std::isfinite(d)) {
                    differences.push_back(d);
                }
            }
        }
    }
    EXPECT_GT(differences.size(), 300U);
    std::nth_element(differences.begin(), differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2),
                     differences.end());
    return differences[differences.size() / 2];
}

TEST(SceneTruth, NamesTheCorrespondingPixelOfTheRenderedImages) {
    const std::string uri = "scene:vga@30?width=336&height=188&loop=5";
    const auto source = open_source(offline_scene(uri));
    const calibration::Rectification rectification =
        calibration::make_rectification(source->info().calibration, 336, 188, {});
    for (int i = 0; i < 3; ++i) {
        RawFrame frame;
        ASSERT_EQ(source->next(frame, soon()), Next::frame);
        const SceneTruth truth = scene_truth(uri, frame.sequence, rectification);
        ASSERT_EQ(truth.disparity.size(), 336U * 188U);
        const double there = median_difference(frame.image, rectification, truth, true, 0);
        EXPECT_LT(there, 3.5) << "noise and interpolation";
        EXPECT_GT(median_difference(frame.image, rectification, truth, true, 2), 1.5 * there);
        EXPECT_GT(median_difference(frame.image, rectification, truth, true, -2), 1.5 * there);
        EXPECT_GT(median_difference(frame.image, rectification, truth, false, 0), 2 * there) << "occluded pixels";
        source->give_back(frame);
    }
}

TEST(SceneTruth, TheSceneHasDepthSlantsAndOcclusions) {
    const std::string uri = "scene:vga@30?width=336&height=188&loop=5";
    const auto source = open_source(offline_scene(uri));
    const calibration::Rectification rectification =
        calibration::make_rectification(source->info().calibration, 336, 188, {});
    const SceneTruth truth = scene_truth(uri, 0, rectification);
    std::size_t visible = 0;
    std::size_t fractional = 0;
    float least = INFINITY;
    float largest = 0;
    for (std::size_t i = 0; i < truth.disparity.size(); ++i) {
        ASSERT_TRUE(std::isfinite(truth.disparity[i]));
        least = std::min(least, truth.disparity[i]);
        largest = std::max(largest, truth.disparity[i]);
        visible += truth.visible[i];
        const float rest = truth.disparity[i] - std::floor(truth.disparity[i]);
        fractional += rest > 0.2F && rest < 0.8F ? 1 : 0;
    }
    const auto all = static_cast<double>(truth.disparity.size());
    EXPECT_GT(least, 0);
    EXPECT_GT(largest, 3 * least) << least;
    EXPECT_LT(largest, 64);
    EXPECT_GT(static_cast<double>(visible) / all, 0.75);
    EXPECT_LT(static_cast<double>(visible) / all, 0.99);
    EXPECT_GT(static_cast<double>(fractional) / all, 0.3) << "slanted surfaces have every fraction of a pixel";
}

TEST(SceneTruth, OfTheSamePlaceIsTheSameInEveryGeometry) {
    const std::string uri = "scene:vga@30?width=336&height=188&loop=5";
    const auto source = open_source(offline_scene(uri));
    const auto& calibration = source->info().calibration;
    const calibration::Rectification whole = calibration::make_rectification(calibration, 336, 188, {});
    const calibration::Rectification part =
        calibration::make_rectification(calibration, 336, 188, {336, 188, {40, 30, 101, 77}});
    const SceneTruth all = scene_truth(uri, 2, whole);
    const SceneTruth some = scene_truth(uri, 7, part);  // one loop later
    for (std::size_t y = 0; y < 77; ++y) {
        for (std::size_t x = 0; x < 101; ++x) {
            ASSERT_NEAR(some.disparity[y * 101 + x], all.disparity[(y + 30) * 336 + x + 40], 1e-4);
        }
    }
}

}  // namespace
}  // namespace disparityd::capture
