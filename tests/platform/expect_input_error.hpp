#pragma once
#include <gmock/gmock.h>

#include "types/error.hpp"

/// Expects that `statement` throws an InputError of one line that contains all of these texts.
#define EXPECT_INPUT_ERROR(statement, ...)                      \
  EXPECT_THAT([&] { statement; },                               \
              ::testing::ThrowsMessage<depthscope::InputError>( \
                  ::testing::AllOf(::testing::Not(::testing::HasSubstr("\n")), __VA_ARGS__)))
