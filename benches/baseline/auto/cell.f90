! Mirror-symmetric stationary shapes of the cortex in its shell, for AUTO-07p (boundary-value problem, IPS = 4).
!
! Half domain u in [0, 1/2], t = 2u in [0, 1] from the pole to the equator; arclength s = L u.
!   U   = r, z, psi, m, q, v, T and, with NDIM = 8, the volume V from the pole on;
!   PAR = xi_s, L, p, b (semi-axis of the shell across; eps = R0**3/(aspect*b**3)).
! The volume is either the eighth equation with its two end values (NDIM = 8, NBC = 10, NINT = 0) or an integral
! condition on seven equations (NDIM = 7, NBC = 8, NINT = 1). Derivatives (JAC = 1) are with respect to U and PAR(1:3).
! Constants are compiled in.

module cell
  implicit none
  double precision, parameter :: pi = 3.14159265358979324d0
  double precision, parameter :: R0 = 2d0, aspect = 1.5d0, w = 0.1445d0, P0 = 0.123d0, gain = 0.5d0, rho = -0.1d0
  double precision, parameter :: kappa = 1d0, eta_b = 1d0, eta_s = 1d0, friction = 1d0, gamma = 0d0
  double precision, parameter :: eta_sum = eta_b + eta_s, eta_difference = eta_b - eta_s
  double precision, parameter :: half_volume = 2*pi*R0**3/3
end module cell

subroutine FUNC(NDIM, U, ICP, PAR, IJAC, F, DFDU, DFDP)
  use cell
  implicit none
  integer, intent(in) :: NDIM, ICP(*), IJAC
  double precision, intent(in) :: U(NDIM), PAR(*)
  double precision, intent(out) :: F(NDIM)
  double precision, intent(inout) :: DFDU(NDIM, NDIM), DFDP(NDIM, *)
  double precision :: r, z, m, q, v, T, si, co, ir, c, c1, c2, d, cot, X, half, S_u, S_p, T_p
  double precision :: ib2, ia2, push, slope, elastic
  double precision :: Sp_r, Sp_psi, Su_r, Su_psi, Su_m, Su_v, Su_T, Tp_r, Tp_psi, Tp_m, Tp_v, Tp_T, S_xi, Tp_xi

  r = U(1); z = U(2); m = U(4); q = U(5); v = U(6); T = U(7)
  if (r == 0) then
     ! The Gauss points never touch the pole; AUTO also stores slopes at the mesh points, which nothing here uses.
     F = 0
     return
  end if
  si = sin(U(3)); co = cos(U(3))
  ir = 1/r
  c2 = si*ir; cot = co*ir
  c = m/kappa; c1 = c - c2; d = c1 - c2
  X = gain*PAR(1)
  half = PAR(2)/2
  ! [strain rate], [stress]
  S_p = cot*v
  S_u = (T - X*((0.5d0 + rho)*c - c2) - eta_difference*S_p)/eta_sum
  T_p = eta_difference*S_u + eta_sum*S_p + X*((rho - 0.5d0)*c + c2)
  ! [shell]: f_c = -push*slope
  ib2 = 1/PAR(4)**2; ia2 = ib2/aspect**2
  push = 2*P0/w**2*exp((z*z*ia2 + r*r*ib2 - 1)/w**2)
  slope = r*si*ib2 + z*co*ia2
  elastic = gamma - 0.5d0*kappa*d*d

  F(1) = half*co
  F(2) = -half*si
  F(3) = half*c1
  F(4) = half*q
  F(5) = half*(-cot*q + c1*T + c2*T_p + elastic*c - PAR(3) + push*slope)
  F(6) = half*S_u
  F(7) = half*(-cot*(T - T_p) + friction*v)
  if (NDIM == 8) F(8) = half*pi*r*r*si
  if (IJAC == 0) return

  Sp_r = -S_p*ir; Sp_psi = -c2*v
  Su_r = (-X*c2*ir - eta_difference*Sp_r)/eta_sum
  Su_psi = (X*cot - eta_difference*Sp_psi)/eta_sum
  Su_m = -X*(0.5d0 + rho)/(kappa*eta_sum)
  Su_v = -eta_difference*cot/eta_sum
  Su_T = 1/eta_sum
  Tp_r = eta_difference*Su_r + eta_sum*Sp_r - X*c2*ir
  Tp_psi = eta_difference*Su_psi + eta_sum*Sp_psi + X*cot
  Tp_m = eta_difference*Su_m + X*(rho - 0.5d0)/kappa
  Tp_v = eta_difference*Su_v + eta_sum*cot
  Tp_T = eta_difference*Su_T

  DFDU = 0
  DFDU(1, 3) = -half*si
  DFDU(2, 3) = -half*co
  DFDU(3, 1) = half*c2*ir
  DFDU(3, 3) = -half*cot
  DFDU(3, 4) = half/kappa
  DFDU(4, 5) = half
  DFDU(5, 1) = half*(cot*ir*q + c2*ir*(T - T_p) + c2*Tp_r - 2*kappa*d*c*c2*ir &
       + push*(2*r*ib2/w**2*slope + si*ib2))
  DFDU(5, 2) = half*push*(2*z*ia2/w**2*slope + co*ia2)
  DFDU(5, 3) = half*(c2*q - cot*(T - T_p) + c2*Tp_psi + 2*kappa*d*c*cot + push*(r*co*ib2 - z*si*ia2))
  DFDU(5, 4) = half*(T/kappa + c2*Tp_m + elastic/kappa - d*c)
  DFDU(5, 5) = -half*cot
  DFDU(5, 6) = half*c2*Tp_v
  DFDU(5, 7) = half*(c1 + c2*Tp_T)
  DFDU(6, 1) = half*Su_r
  DFDU(6, 3) = half*Su_psi
  DFDU(6, 4) = half*Su_m
  DFDU(6, 6) = half*Su_v
  DFDU(6, 7) = half*Su_T
  DFDU(7, 1) = half*(cot*ir*(T - T_p) + cot*Tp_r)
  DFDU(7, 3) = half*(c2*(T - T_p) + cot*Tp_psi)
  DFDU(7, 4) = half*cot*Tp_m
  DFDU(7, 6) = half*(cot*Tp_v + friction)
  DFDU(7, 7) = half*cot*(Tp_T - 1)
  if (NDIM == 8) then
     DFDU(8, 1) = 2*half*pi*r*si
     DFDU(8, 3) = half*pi*r*r*co
  end if
  if (IJAC == 1) return

  S_xi = -gain*((0.5d0 + rho)*c - c2)/eta_sum
  Tp_xi = eta_difference*S_xi + gain*((rho - 0.5d0)*c + c2)
  DFDP(:, 1) = 0
  DFDP(5, 1) = half*c2*Tp_xi
  DFDP(6, 1) = half*S_xi
  DFDP(7, 1) = half*cot*Tp_xi
  DFDP(:, 2) = F/PAR(2)
  DFDP(:, 3) = 0
  DFDP(5, 3) = -half
end subroutine FUNC

! The unloaded sphere: exact for xi_s = 0 as long as the shell is out of reach.
subroutine STPNT(NDIM, U, PAR, T)
  use cell
  implicit none
  integer, intent(in) :: NDIM
  double precision, intent(inout) :: U(NDIM), PAR(*)
  double precision, intent(in) :: T
  double precision :: psi

  PAR(1) = 0
  PAR(2) = pi*R0
  PAR(3) = (2/R0)*gamma
  PAR(4) = 1.3d0*R0
  psi = pi*T/2
  U(1) = R0*sin(psi)
  U(2) = R0*cos(psi)
  U(3) = psi
  U(4) = 2*kappa/R0
  U(5:7) = 0
  if (NDIM == 8) U(8) = pi*R0**3*(2 - 3*cos(psi) + cos(psi)**3)/3
end subroutine STPNT

subroutine BCND(NDIM, PAR, ICP, NBC, U0, U1, FB, IJAC, DBC)
  use cell
  implicit none
  integer, intent(in) :: NDIM, ICP(*), NBC, IJAC
  double precision, intent(in) :: PAR(*), U0(NDIM), U1(NDIM)
  double precision, intent(out) :: FB(NBC)
  double precision, intent(inout) :: DBC(NBC, *)

  ! Pole: r, psi, q, v vanish. Equator: z, q, v vanish, psi = pi/2.
  FB(1:4) = U0((/1, 3, 5, 6/))
  FB(5:8) = U1((/2, 3, 5, 6/))
  FB(6) = FB(6) - pi/2
  if (NBC == 10) then
     FB(9) = U0(8)
     FB(10) = U1(8) - half_volume
  end if
  if (IJAC == 0) return
  DBC(:, 1:2*NDIM + 3) = 0
  DBC(1, 1) = 1
  DBC(2, 3) = 1
  DBC(3, 5) = 1
  DBC(4, 6) = 1
  DBC(5, NDIM + 2) = 1
  DBC(6, NDIM + 3) = 1
  DBC(7, NDIM + 5) = 1
  DBC(8, NDIM + 6) = 1
  if (NBC == 10) then
     DBC(9, 8) = 1
     DBC(10, NDIM + 8) = 1
  end if
end subroutine BCND

subroutine ICND(NDIM, PAR, ICP, NINT, U, UOLD, UDOT, UPOLD, FI, IJAC, DINT)
  use cell
  implicit none
  integer, intent(in) :: NDIM, ICP(*), NINT, IJAC
  double precision, intent(in) :: PAR(*), U(NDIM), UOLD(NDIM), UDOT(NDIM), UPOLD(NDIM)
  double precision, intent(out) :: FI(NINT)
  double precision, intent(inout) :: DINT(NINT, *)
  double precision :: swept

  swept = pi*U(1)**2*sin(U(3))/2
  FI(1) = PAR(2)*swept - half_volume
  if (IJAC == 0) return
  DINT(1, 1:NDIM + 3) = 0
  DINT(1, 1) = PAR(2)*pi*U(1)*sin(U(3))
  DINT(1, 3) = PAR(2)*pi*U(1)**2*cos(U(3))/2
  DINT(1, NDIM + 2) = swept
end subroutine ICND

subroutine FOPT()
end subroutine FOPT

subroutine PVLS()
end subroutine PVLS
