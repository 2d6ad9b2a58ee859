% A hybrid model by ode45 with events, for comparison.
%   octave --no-gui --norc --quiet ode45_hybrid.m PROBLEM.json ANSWER.json REPETITIONS
% The problem is that of bench_hybrid, in SI units; the answer has the shortest CPU time in s, the final
% state and the times of the switches.
1;

function y = polynomial(p, u)
  y = polyval(flip(p.c(:)), u / p.per);
end

function dx = motion(x, m, problem, u)
  dx = [x(2);
        (problem.gamma * x(3) - m.k * (x(1) - m.rest) - m.b * x(2)) / problem.mass;
        m.alpha * x(3) + m.beta * u];
end

function [value, terminal, direction] = guards(x, list)
  value = x([list.quantity] + 1)(:) - [list.level](:);
  terminal = ones(numel(list), 1);
  direction = [list.direction](:);
end

% The coefficients of a mode under the set-point u.
function m = coefficients(mode, u)
  m = struct('rest', mode.rest, 'k', polynomial(mode.stiffness, u), ...
             'b', polynomial(mode.damping, u), 'alpha', polynomial(mode.alpha, u), ...
             'beta', polynomial(mode.beta, u));
end

function [x, switches, steps] = simulate(problem)
  x = problem.initial(:);
  mode = problem.initial_mode + 1;
  switches = [];
  steps = 0;
  corners = [problem.time(:); problem.stop];
  for i = 1:numel(problem.value)
    u = problem.value(i);
    t = corners(i);
    while t < corners(i + 1)
      m = coefficients(problem.modes(mode), u);
      list = problem.transitions([problem.transitions.from] + 1 == mode);
      options = odeset('RelTol', problem.tolerance, 'AbsTol', problem.tolerance * problem.size(:), ...
                       'Events', @(t, x) guards(x, list));
      [ts, xs, te, xe, ie] = ode45(@(t, x) motion(x, m, problem, u), [t, corners(i + 1)], x, options);
      steps += numel(ts) - 1;
      if isempty(ie)
        t = corners(i + 1);
        x = xs(end, :)';
      else
        made = list(ie(end));
        t = te(end);
        x = made.reset(:, 1) .* xe(end, :)' + made.reset(:, 2);
        mode = made.to + 1;
        switches(end + 1) = t;
      end
    end
  end
end

files = argv();
problem = jsondecode(fileread(files{1}));
best = Inf;
for repetition = 1:str2double(files{3})
  start = cputime();
  [x, switches, steps] = simulate(problem);
  best = min(best, cputime() - start);
end
file = fopen(files{2}, 'w');
fprintf(file, '{"version": "%s", "time_s": %.6g, "points": %d, "final": [%.17g, %.17g, %.17g], "switches": [%s]}\n', ...
        version(), best, steps, x, strjoin(arrayfun(@(t) sprintf('%.17g', t), switches, 'UniformOutput', false), ', '));
fclose(file);
