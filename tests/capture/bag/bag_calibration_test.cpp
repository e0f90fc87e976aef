// SPDX-License-Identifier: Apache-2.0
//
// CameraInfo as calibration.
#include "calibration/lens.h"
#include "capture/frame_source.h"
#include "tests/capture/bag/bag_fixture.h"
#include "tests/capture/images/image_fixture.h"
#include "tests/temporary_folder.h"

namespace disparityd::capture {
namespace {

using disparityd::test::bag_start_ns;
using disparityd::test::BagWriter;
using disparityd::test::CameraInfoFields;
using disparityd::test::TemporaryFolder;
using test::numbered_image;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A bag with one pair of images and the information of both cameras.
struct Bag {
    std::string images = "image_raw";
    int width = 64;
    int height = 48;
    CameraInfoFields left;
    CameraInfoFields right = left.right_of(0.12);

    /// Both cameras with the same change.
    template <class Change>
    static Bag with(Change change) {
        Bag bag;
        change(bag.left);
        bag.right = bag.left.right_of(0.12);
        return bag;
    }

    std::string write(const TemporaryFolder& folder) const {
        BagWriter writer;
        const cv::Mat image = numbered_image(width, height, CV_8UC1, 1);
        writer.image("/left/" + images, bag_start_ns, image, "mono8");
        writer.image("/right/" + images, bag_start_ns, image, "mono8");
        writer.camera_info("/left/camera_info", bag_start_ns, left);
        writer.camera_info("/right/camera_info", bag_start_ns, right);
        return folder.write("a.mcap", writer.close());
    }
};

/// What a source says of its calibration.
struct Found {
    std::optional<calibration::StereoCalibration> calibration;
    std::vector<std::string> notices;
    std::string problem;
};

Found found_in(const Bag& bag, const std::string& parameters = "", const std::string& other_calibration = "") {
    const TemporaryFolder folder;
    Found found;
    SourceOptions options;
    options.uri = bag.write(folder) + parameters;
    options.report = [&](const std::string& line, bool) { found.notices.push_back(line); };
    if (!other_calibration.empty()) {
        options.calibration_path = folder.write("stereo.txt", other_calibration);
    }
    try {
        found.calibration = open_source(options)->info().calibration;
    } catch (const std::invalid_argument& error) {
        found.problem = error.what();
    }
    return found;
}

TEST(BagCalibration, OfRawImagesHasTheLens) {
    const Found found = found_in(Bag());
    EXPECT_THAT(found.notices, IsEmpty());
    ASSERT_TRUE(found.calibration) << found.problem;
    EXPECT_FALSE(found.calibration->rectified);
    EXPECT_EQ(found.calibration->left.fx, 60);
    EXPECT_EQ(found.calibration->left.cx, 31);
    EXPECT_THAT(calibration::lens_coefficients(found.calibration->left), ElementsAre(0.1, -0.05, 0.001, 0.002, 0.01));
    EXPECT_NEAR(found.calibration->translation[0], -120, 1e-9);
}

TEST(BagCalibration, HasThePlaceOfTheInertialSensor) {
    // The body's axes point ahead, left and up, those of the images right, down and ahead.
    const std::vector<disparityd::test::TransformFields> whole{
        {"base", "link", {0.1, 0, 0}}, {"link", "/camera", {}, {-0.5, 0.5, -0.5, 0.5}}, {"base", "imu", {0, 0.2, 0}}};
    const auto place_by = [](const std::vector<disparityd::test::TransformFields>& transforms,
                             const std::string& images = "image_raw",
                             const std::array<double, 9>& r = CameraInfoFields().r) {
        const TemporaryFolder folder;
        BagWriter writer;
        const cv::Mat image = numbered_image(64, 48, CV_8UC1, 1);
        CameraInfoFields left;
        left.r = r;
        for (const std::string eye : {"/left", "/right"}) {
            writer.image(eye + "/" + images, bag_start_ns, image, "mono8");
            writer.camera_info(eye + "/camera_info", bag_start_ns, eye == "/left" ? left : left.right_of(0.12));
        }
        writer.transforms(bag_start_ns, transforms);
        writer.imu("/imu", bag_start_ns, 0, 9.8);
        SourceOptions options;
        options.uri = folder.write("a.mcap", writer.close());
        return open_source(options)->info().calibration.value().inertial.to_left_camera;
    };
    const auto place = place_by(whole);
    ASSERT_TRUE(place);
    const std::array<double, 9> turned{0, -1, 0, 0, 0, -1, 1, 0, 0};
    for (std::size_t i = 0; i < turned.size(); ++i) {
        EXPECT_NEAR(place->rotation[i], turned[i], 1e-9) << i;
    }
    EXPECT_NEAR(place->translation[0], -200, 1e-6);
    EXPECT_NEAR(place->translation[1], 0, 1e-6);
    EXPECT_NEAR(place->translation[2], -100, 1e-6);
    // Rectified images are those of a camera that R has turned: here its x is the raw one's y, its y the raw one's -x.
    const auto rectified = place_by(whole, "image_rect", {0, 1, 0, -1, 0, 0, 0, 0, 1});
    ASSERT_TRUE(rectified);
    const std::array<double, 9> turned_twice{0, 0, -1, 0, 1, 0, 1, 0, 0};
    for (std::size_t i = 0; i < turned.size(); ++i) {
        EXPECT_NEAR(rectified->rotation[i], turned_twice[i], 1e-9) << i;
    }
    EXPECT_NEAR(rectified->translation[0], 0, 1e-6);
    EXPECT_NEAR(rectified->translation[1], 200, 1e-6);
    EXPECT_NEAR(rectified->translation[2], -100, 1e-6);
    EXPECT_FALSE(place_by(whole, "image_rect", {}));                                    // an R that is no rotation
    EXPECT_FALSE(place_by({whole[0], whole[2]}));                                       // no way
    EXPECT_FALSE(place_by({whole[0], whole[1], {"other", "imu"}}));                     // nothing in common
    EXPECT_FALSE(place_by({{"link", "camera"}, {"camera", "link"}, {"link", "imu"}}));  // a circle
    EXPECT_FALSE(place_by({whole[0], whole[1], {"base", "imu", {200, 0, 0}}}));         // too far
    EXPECT_FALSE(place_by({whole[0], whole[1], {"base", "imu", {0, 0.2, 0}, {0, 0, 0, 0}}}));  // no rotation
}

TEST(BagCalibration, OfRectifiedImagesIsTheProjection) {
    Bag bag;
    bag.images = "image_rect";
    for (const Found& found : {found_in(bag), found_in(Bag(), "?rectified=yes")}) {
        ASSERT_TRUE(found.calibration) << found.problem;
        EXPECT_TRUE(found.calibration->rectified);
        EXPECT_EQ(found.calibration->left.fx, 58);
        EXPECT_EQ(found.calibration->left.cx, 32);
        EXPECT_THAT(calibration::lens_coefficients(found.calibration->left), ElementsAre(0, 0, 0, 0, 0));
        EXPECT_NEAR(found.calibration->translation[0], -120, 1e-9);
    }
    EXPECT_FALSE(found_in(bag, "?rectified=no").calibration->rectified);
}

TEST(BagCalibration, BinningAndRegionAreThoseOfTheImages) {
    const Found found = found_in(Bag::with([](CameraInfoFields& fields) {
        fields.width = 200;
        fields.height = 150;
        fields.k = {120, 0, 82, 0, 120, 66, 0, 0, 1};
        fields.p = {116, 0, 84, 0, 0, 116, 68, 0, 0, 0, 1, 0};
        fields.binning = 2;
        fields.roi = {20, 20, 96, 128};
    }));
    ASSERT_TRUE(found.calibration) << found.problem;
    EXPECT_EQ(found.calibration->left.fx, 60);
    EXPECT_EQ(found.calibration->left.cx, 31);
    EXPECT_EQ(found.calibration->left.cy, 23);
    EXPECT_NEAR(found.calibration->translation[0], -120, 1e-9);
}

TEST(BagCalibration, FisheyeAndRationalLensesAreTaken) {
    for (const auto& [model, numbers, lens] :
         {std::tuple("equidistant", std::vector<double>{0.1, 0.1, 0.1, 0.1}, calibration::LensModel::fisheye),
          {"rational_polynomial", {0.1, 0.1, 0, 0, 0, 0.2, 0.1, 0.1}, calibration::LensModel::pinhole}}) {
        const Found found = found_in(Bag::with([&model = model, &numbers = numbers](CameraInfoFields& fields) {
            fields.model = model;
            fields.distortion = numbers;
        }));
        ASSERT_TRUE(found.calibration) << found.problem;
        EXPECT_EQ(found.calibration->left.lens, lens);
        EXPECT_EQ(calibration::lens_coefficients(found.calibration->right), numbers);
    }
}

TEST(BagCalibration, ThatCannotBeUsedIsRefusedUnlessAnotherIsNamed) {
    const Bag unknown = Bag::with([](CameraInfoFields& fields) { fields.model = "omni"; });
    EXPECT_THAT(found_in(unknown).problem, AllOf(HasSubstr("a.mcap: /left/camera_info"), HasSubstr("omni")));
    const Bag odd = Bag::with([](CameraInfoFields& fields) { fields.model = "a: [\n"; });
    EXPECT_THAT(found_in(odd).problem, HasSubstr("found 'a: [?', a lens model that is not known"));
    const Bag other_size = Bag::with([](CameraInfoFields& fields) { fields.width = 640; });
    EXPECT_THAT(found_in(other_size).problem, HasSubstr("is for eyes of 640x48 pixels, the frames have 64x48"));
    EXPECT_THAT(found_in(other_size, "?rectified=yes").problem, HasSubstr("is for eyes of 640x48 pixels"));
    Bag single;
    single.right = single.left;
    EXPECT_THAT(found_in(single).problem, HasSubstr("the calibrations of two single cameras"));

    const std::string middlebury =
        "cam0=[60 0 31; 0 60 23; 0 0 1]\ncam1=[60 0 31; 0 60 23; 0 0 1]\ndoffs=0\nbaseline=120\nwidth=64\nheight=48\n";
    const Found named = found_in(unknown, "", middlebury);
    ASSERT_TRUE(named.calibration) << named.problem;
    EXPECT_EQ(named.calibration->left.fx, 60);
}

TEST(BagCalibration, ThatIsMissingIsTold) {
    const Bag none = Bag::with([](CameraInfoFields& fields) { fields.k = {}; });
    const Found found = found_in(none);
    EXPECT_FALSE(found.calibration);
    EXPECT_THAT(found.notices, ElementsAre(HasSubstr("has no calibration: distances are not known")));
}

}  // namespace
}  // namespace disparityd::capture
