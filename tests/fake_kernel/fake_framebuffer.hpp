#pragma once
#include <linux/fb.h>

#include <cstring>

#include "tests/fake_kernel/fake_kernel.hpp"

namespace depthscope::fake {

/// A Linux framebuffer of packed pixels with room for one screen or more.
class FakeFramebuffer final : public FakeDevice {
 public:
  FakeFramebuffer(FakeKernel& kernel, std::string path, int width, int height, int bits,
                  int screens_of_memory)
      : kernel_(kernel), path_(std::move(path)) {
    setMode(width, height, bits);
    fix_.smem_len = fix_.line_length * var_.yres * static_cast<unsigned>(screens_of_memory);
    fix_.ypanstep = 1;
    memory_.reset(new std::byte[fix_.smem_len]);
    std::memset(memory_.get(), 0x5a, fix_.smem_len);  // the console
    kernel_.plug(path_, *this);
  }
  ~FakeFramebuffer() override { kernel_.unplug(path_); }

  int open(int, std::unique_ptr<FakeFile>& file) override {
    if (denied) return -EACCES;
    file = std::make_unique<File>(*this);
    return 0;
  }
  /// Another program sets another mode.
  void setMode(int width, int height, int bits) {
    var_ = {};
    var_.xres = var_.xres_virtual = static_cast<unsigned>(width);
    var_.yres = var_.yres_virtual = static_cast<unsigned>(height);
    var_.bits_per_pixel = static_cast<unsigned>(bits);
    if (bits == 16) {
      var_.red.offset = 11;
      var_.green.offset = 5;
    } else {
      var_.red.offset = 16;
      var_.green.offset = 8;
    }
    fix_.line_length = (var_.xres * var_.bits_per_pixel / 8 + 31) & ~31u;
    fix_.type = FB_TYPE_PACKED_PIXELS;
  }
  void setPresent(bool here) {
    present_ = here;
    if (here)
      kernel_.plug(path_, *this);
    else
      kernel_.unplug(path_);
  }
  /// The bytes of a pixel on screen, lowest first.
  std::uint32_t pixel(int x, int y) const {
    std::uint32_t word = 0;
    std::memcpy(&word,
                memory_.get() + (static_cast<unsigned>(y) + var_.yoffset) * fix_.line_length +
                    static_cast<unsigned>(x) * var_.bits_per_pixel / 8,
                var_.bits_per_pixel / 8);
    return word;
  }
  unsigned yOffset() const { return var_.yoffset; }

  bool denied = false;
  bool can_pan = true;
  fb_var_screeninfo var_{};
  fb_fix_screeninfo fix_{};
  int unblanked = 0;

 private:
  struct File final : FakeFile {
    explicit File(FakeFramebuffer& owner) : fb(owner) {}
    int ioctl(unsigned long request, void* argument) override {
      if (!fb.present_) return -ENODEV;
      auto* var = static_cast<fb_var_screeninfo*>(argument);
      switch (request) {
        case FBIOGET_VSCREENINFO:
          *var = fb.var_;
          return 0;
        case FBIOGET_FSCREENINFO:
          *static_cast<fb_fix_screeninfo*>(argument) = fb.fix_;
          return 0;
        case FBIOPUT_VSCREENINFO:
          if (var->yres_virtual * fb.fix_.line_length > fb.fix_.smem_len) return -EINVAL;
          fb.var_ = *var;
          return 0;
        case FBIOPAN_DISPLAY:
          if (!fb.can_pan || var->yoffset + fb.var_.yres > fb.var_.yres_virtual) return -EINVAL;
          fb.var_.yoffset = var->yoffset;
          return 0;
        case FBIOBLANK:
          ++fb.unblanked;
          return 0;
        default:
          return -ENOTTY;
      }
    }
    std::shared_ptr<std::byte[]> map(std::size_t length, off_t offset, int& error) override {
      error = offset == 0 && length <= fb.fix_.smem_len ? 0 : -EINVAL;
      return error == 0 ? fb.memory_ : nullptr;
    }
    FakeFramebuffer& fb;
  };

  FakeKernel& kernel_;
  std::string path_;
  std::shared_ptr<std::byte[]> memory_;
  bool present_ = true;
};

}  // namespace depthscope::fake
