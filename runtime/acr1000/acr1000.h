// The way into the ACR1000 runtime: one-axis cards that run line programs and move together over a common master distance.
#pragma once

#include "runtime/acr1000/axis_law.h"
#include "runtime/acr1000/card_memory.h"
#include "runtime/acr1000/card_system.h"
#include "runtime/acr1000/master_profile.h"
#include "runtime/acr1000/move_block.h"
#include "runtime/acr1000/rates.h"
