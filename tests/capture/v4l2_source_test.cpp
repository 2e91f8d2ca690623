#include "tests/capture/v4l2_test_card.hpp"
#include "types/error.hpp"

namespace depthscope::capture {
namespace {

TEST_F(V4l2Test, PicturesComeAtTheirTimesWithTheirNumbers) {
  plug({});
  open();
  Frame last = nextPicture();
  ASSERT_FALSE(last.empty());
  EXPECT_NEAR(source->fps(), 50, 0.1);
  for (std::uint64_t i = 1; i < 10; ++i) {
    Frame frame = nextPicture();
    EXPECT_EQ(frame.sequence, i);
    const double step =
        std::chrono::duration<double, std::milli>(frame.capture_time - last.capture_time).count();
    EXPECT_NEAR(step, 20, 0.1);
    EXPECT_LE(frame.capture_time, kernel.now());
    EXPECT_LT(kernel.now() - frame.capture_time, 1ms);
    last = std::move(frame);
  }
  EXPECT_EQ(source->skipped(), 0u);
}

TEST_F(V4l2Test, PicturesAreTheCardsOwnMemoryAndAreOfferedAsDmabuf) {
  plug({.multiplanar = true, .formats = {V4L2_PIX_FMT_NV12M}});
  open();
  const Frame frame = nextPicture();
  ASSERT_FALSE(frame.empty());
  EXPECT_NE(kernel.file(frame.dma[0].fd), nullptr);
  EXPECT_NE(kernel.file(frame.dma[1].fd), nullptr);
  EXPECT_NE(frame.dma[0].fd, frame.dma[1].fd);
}

TEST_F(V4l2Test, WithoutDmabufExportPicturesComeAllTheSame) {
  plug({.exports = false});
  open();
  const Frame frame = nextPicture();
  ASSERT_FALSE(frame.empty());
  EXPECT_EQ(frame.dma[0].fd, -1);
}

TEST_F(V4l2Test, TheNewestWinsAndTheOthersAreCounted) {
  plug({});
  open();
  nextPicture();
  kernel.advance(100ms);  // five more pictures
  const Frame frame = nextPicture();
  EXPECT_EQ(frame.sequence, 5u);
  EXPECT_EQ(source->skipped(), 4u);
  EXPECT_LE(farthest(frame, [](int x, int y) { return bars(x, y, 5, 0); }), 2.0);
}

/// All buffers were filled long ago and the card had none left: the newest of them is old.
TEST_F(V4l2Test, AfterALongPauseNoOldPictureComes) {
  for (const bool monotonic : {true, false}) {
    plug({.monotonic = monotonic});
    open();
    nextPicture();
    kernel.advance(1s);
    const auto asked = kernel.now();
    const ReadResult result = source->read(80ms);
    ASSERT_EQ(result.status, SourceStatus::Ok);
    EXPECT_GT(result.frame.capture_time, asked - 20ms);
    EXPECT_GE(result.frame.sequence, 51u);
    EXPECT_EQ(source->skipped(), result.frame.sequence - 1);
  }
}

TEST_F(V4l2Test, AConsumerThatKeepsPicturesNeverStarvesTheCard) {
  plug({});
  open({.buffers = 5});
  std::vector<Frame> kept;
  for (int i = 0; i < 3; ++i) kept.push_back(nextPicture());
  for (const Frame& frame : kept) ASSERT_FALSE(frame.empty());
  EXPECT_NE(source->read(80ms).status, SourceStatus::Ok);
  EXPECT_GE(card->queuedBuffers(), 2u);
  kept.erase(kept.begin());
  const Frame newest = nextPicture();
  ASSERT_FALSE(newest.empty());
  EXPECT_GT(newest.sequence, 6u) << "the newest wins";
}

TEST_F(V4l2Test, APictureMayOutliveItsSource) {
  plug({});
  open();
  Frame frame = nextPicture();
  source.reset();
  EXPECT_LE(farthest(frame, [](int x, int y) { return bars(x, y, 0, 0); }), 2.0);
  frame = Frame();
}

TEST_F(V4l2Test, APictureThatIsStillShownDoesNotKeepTheCardBusy) {
  plug({});
  open();
  Frame shown = nextPicture();
  card->setMode(fake::timingsSmall(32, 32, 50));
  const Frame next = nextPicture();
  ASSERT_FALSE(next.empty()) << source->detail();
  EXPECT_EQ(next.format.width, 32);
}

TEST_F(V4l2Test, FaultsOfTheSignalAreToldApartAtOnceAndGoBackToPictures) {
  using Signal = FakeV4l2Card::Signal;
  const std::pair<Signal, SourceStatus> faults[] = {
      {Signal::NoCable, SourceStatus::NoCable},
      {Signal::Missing, SourceStatus::NoSignal},
      {Signal::Unlocked, SourceStatus::UnstableSync},
      {Signal::OutOfRange, SourceStatus::UnsupportedMode}};
  for (const bool events : {true, false}) {
    plug({.events = events});
    open();
    nextPicture();
    for (const auto& [signal, status] : faults) {
      const auto broken = kernel.now();
      card->setSignal(signal);
      EXPECT_EQ(nextFault(), status);
      EXPECT_LE(kernel.now() - broken, events ? 1ms : 101ms);
      EXPECT_FALSE(source->detail().empty());
      EXPECT_EQ(source->read(80ms).status, status);
      const auto mended = kernel.now();
      card->setSignal(Signal::Good);
      const Frame frame = nextPicture();
      ASSERT_FALSE(frame.empty());
      EXPECT_LE(farthest(frame, [](int x, int y) { return bars(x, y, 0, 0); }), 2.0);
      EXPECT_LE(kernel.now() - mended, 150ms);
    }
  }
}

TEST_F(V4l2Test, AFaultThatLastsIsSaidAfterTheTimeoutAndANewOneAtOnce) {
  plug({});
  open();
  nextPicture();
  card->setSignal(FakeV4l2Card::Signal::Missing);
  EXPECT_EQ(nextFault(), SourceStatus::NoSignal);
  auto start = kernel.now();
  EXPECT_EQ(source->read(80ms).status, SourceStatus::NoSignal);
  EXPECT_GE(kernel.now() - start, 80ms);
  start = kernel.now();
  card->at(start + 30ms, [&] { card->setSignal(FakeV4l2Card::Signal::Unlocked); });
  EXPECT_EQ(source->read(80ms).status, SourceStatus::UnstableSync);
  EXPECT_LT(kernel.now() - start, 32ms);
}

TEST_F(V4l2Test, AnotherModeIsTakenUpWhileItRuns) {
  plug({});
  open();
  nextPicture();
  card->setMode(fake::timingsSmall(96, 32, 25));
  ReadResult result = source->read(200ms);
  ASSERT_EQ(result.status, SourceStatus::Ok);
  EXPECT_TRUE(result.format_changed);
  EXPECT_EQ(result.frame.format.width, 96);
  EXPECT_EQ(result.frame.format.height, 32);
  EXPECT_NEAR(source->fps(), 25, 0.1);
  EXPECT_EQ(result.frame.sequence, 1u) << "numbers go on";
  result = source->read(200ms);
  EXPECT_FALSE(result.format_changed);
}

TEST_F(V4l2Test, ACardPulledOutAndPutBackGoesOn) {
  plug({.name = "Tower"});
  open({.device = "name:Tower"});
  const Frame held = nextPicture();
  card->disconnect();
  kernel.unplug("/dev/video0");
  EXPECT_EQ(nextFault(), SourceStatus::NoDevice);
  EXPECT_EQ(source->read(80ms).status, SourceStatus::NoDevice);
  kernel.advance(3s);
  EXPECT_EQ(source->read(80ms).status, SourceStatus::NoDevice);
  FakeV4l2Card other(kernel, {.name = "Webcam"}), again(kernel, {.name = "Tower 2"});
  kernel.plug("/dev/video0", other);
  kernel.plug("/dev/video12", again);
  const auto back = kernel.now();
  const Frame frame = nextPicture();
  ASSERT_FALSE(frame.empty()) << source->detail();
  EXPECT_GT(frame.sequence, held.sequence);
  EXPECT_TRUE(again.streaming());
  EXPECT_FALSE(other.streaming());
  EXPECT_LE(kernel.now() - back, 150ms);
  source.reset();
}

TEST_F(V4l2Test, DamagedPicturesAreCountedAndNotShown) {
  plug({});
  open();
  nextPicture();
  card->damageNext(1);
  EXPECT_EQ(nextPicture().sequence, 2u);
  EXPECT_EQ(source->damagedFrames(), 1u);
  card->shortenNext(1);
  EXPECT_EQ(nextPicture().sequence, 4u);
  EXPECT_EQ(source->damagedFrames(), 2u);
  EXPECT_EQ(source->skipped(), 0u);
  card->damageNext(1000);
  EXPECT_EQ(source->read(80ms).status, SourceStatus::Timeout) << "a pause at first";
  EXPECT_EQ(source->read(200ms).status, SourceStatus::DamagedFrames);
  card->damageNext(0);
  EXPECT_FALSE(nextPicture(40ms).empty());
}

TEST_F(V4l2Test, ASignalWithoutPicturesIsAFaultOfItsOwnAndTheCardIsOpenedAnew) {
  plug({});
  open({.restart_ms = 500});
  nextPicture();
  card->stall(true);
  auto start = kernel.now();
  EXPECT_EQ(source->read(80ms).status, SourceStatus::Timeout) << "a pause at first";
  EXPECT_LE(kernel.now() - start, 81ms);
  EXPECT_EQ(source->read(80ms).status, SourceStatus::Timeout);
  EXPECT_EQ(source->read(100ms).status, SourceStatus::NoFrames);
  const std::uint64_t before = kernel.calls();
  for (int i = 0; i < 5; ++i) EXPECT_EQ(source->read(80ms).status, SourceStatus::NoFrames);
  EXPECT_GT(kernel.calls() - before, 30u) << "not opened again";
  card->stall(false);
  EXPECT_FALSE(nextPicture().empty());
}

TEST_F(V4l2Test, AnExpiredTimeoutRightAfterAPictureIsNoFaultYet) {
  plug({});
  open();
  nextPicture();
  EXPECT_EQ(source->read(5ms).status, SourceStatus::Timeout);
  EXPECT_EQ(source->read(-1s).status, SourceStatus::Timeout);
}

TEST_F(V4l2Test, StartsWithoutACardAndTakesItWhenItComes) {
  open();
  EXPECT_EQ(source->read(80ms).status, SourceStatus::NoDevice);
  EXPECT_EQ(source->detail(), "no capture device found");
  card = std::make_unique<FakeV4l2Card>(kernel, FakeV4l2Card::Options{});
  kernel.plug("/dev/video3", *card);
  EXPECT_FALSE(nextPicture().empty());
}

TEST_F(V4l2Test, SaysWhenItMayNotOpenTheCardOrAnotherHasIt) {
  plug({});
  card->refuseOpen(EACCES);
  open();
  EXPECT_EQ(source->read(80ms).status, SourceStatus::PermissionDenied);
  EXPECT_EQ(source->detail(), "/dev/video0: Permission denied");
  card->refuseOpen(0);
  auto other = std::make_unique<V4l2Source>(V4l2Settings{.device = "auto"}, kernel);
  EXPECT_EQ(nextFault(), SourceStatus::PermissionDenied);
  EXPECT_EQ(nextFault(), SourceStatus::DeviceBusy);
  other.reset();
  EXPECT_FALSE(nextPicture().empty());
}

TEST_F(V4l2Test, IsSelectedByPathLinkNameAndBus) {
  FakeV4l2Card other(kernel, {.name = "Webcam", .bus = "usb-1"});
  kernel.plug("/dev/video0", other);
  FakeV4l2Card tower(kernel, {.name = "Fake HDMI", .bus = "PCI:7"});
  kernel.plug("/dev/video10", tower);
  kernel.link("/dev/v4l/by-path/pci-7", "/dev/video10");
  for (const char* selection :
       {"/dev/video10", "/dev/v4l/by-path/pci-7", "name:HDMI", "bus:PCI:7"}) {
    open({.device = selection});
    EXPECT_TRUE(tower.streaming()) << selection;
    EXPECT_FALSE(other.streaming()) << selection;
    source.reset();
  }
  open({.device = "name:Nothing"});
  EXPECT_EQ(source->read(0ms).status, SourceStatus::NoDevice);
  EXPECT_EQ(source->detail(), "none of 2 video nodes is name:Nothing");
  EXPECT_THROW(open({.device = "HDMI"}), InputError);
  source.reset();
}

TEST_F(V4l2Test, TheInputIsChosenByNameOrNumber) {
  plug({.inputs = {"Composite", "HDMI", "SDI"}});
  open({.input = "SDI"});
  EXPECT_EQ(card->currentInput(), 2);
  source.reset();
  open({.input = "1"});
  EXPECT_EQ(card->currentInput(), 1);
  source.reset();
  open({.input = "DVI"});
  EXPECT_EQ(source->read(0ms).status, SourceStatus::NoDevice);
  EXPECT_NE(source->detail().find("\"Composite\""), std::string::npos) << source->detail();
}

}  // namespace
}  // namespace depthscope::capture
