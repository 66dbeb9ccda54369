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

-- The inverse kinematics of interpreter_bench.cpp; what the script keeps in P and C variables is in a table and in arguments.
local arm = {upper = 400.0, fore = 300.0, vertical = 250.0}
local deg = 180.0 / math.pi

local function inverse(x, y, z, c)
  local distance2 = x * x + y * y
  local cos_elbow = (distance2 - arm.upper * arm.upper - arm.fore * arm.fore) / (2 * arm.upper * arm.fore)
  if math.abs(cos_elbow) > 1 then error("out of reach") end
  local motor2 = math.acos(cos_elbow) * deg
  local cos_shoulder = (distance2 + arm.upper * arm.upper - arm.fore * arm.fore) / (2 * arm.upper * math.sqrt(distance2))
  local motor1 = math.atan(y, x) * deg - math.acos(cos_shoulder) * deg
  return motor1, motor2, c - motor1 - motor2, z - arm.vertical
end

local calls = passes // 5

function scara()
  local sum = 0.0
  for call = 0, calls - 1 do
    local motor1 = inverse(450 + 1e-4 * call, -100 + 2e-4 * call, 200.0, 10.0)
    sum = sum + motor1
  end
end

for name, loop in pairs({locals = locals, globals = globals, scara = scara}) do
  local best = math.huge
  for _ = 1, runs do
    local start = os.clock()
    loop()
    best = math.min(best, os.clock() - start)
  end
  print(name, best / (name == "scara" and calls or passes) * 1e9)
end
