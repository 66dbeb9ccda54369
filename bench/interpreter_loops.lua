-- The loops of interpreter_bench.cpp in Lua 5.4, numbers as floats as in the script. Prints nanoseconds a pass, best of many.
local passes, runs = 1000000, 20

local function locals()
  local a, b, c, d, n = 0.0, 0.0, 0.0, 0.0, passes + 0.0
  while a < n do a = a + 1; b = b + a; c = b * 2; d = c - b end
end

function globals()  -- P variables are global: a global is the nearest thing that Lua has
  P1, P2, P3, P4, n = 0.0, 0.0, 0.0, 0.0, passes + 0.0
  while P1 < n do P1 = P1 + 1; P2 = P2 + P1; P3 = P2 * 2; P4 = P3 - P2 end
end

for name, loop in pairs({locals = locals, globals = globals}) do
  local best = math.huge
  for _ = 1, runs do
    local start = os.clock()
    loop()
    best = math.min(best, os.clock() - start)
  end
  print(name, best / passes * 1e9)
end
