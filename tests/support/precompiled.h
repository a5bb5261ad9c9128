// What nearly every test includes, precompiled where KESTREL_PCH is on; no file may count on it.
#pragma once
#include "../../framework/cmake/precompiled.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
